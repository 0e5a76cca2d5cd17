# Shortcuts; the programs themselves are built by CMake (README.md).
#
#   make help     this
#   make build    installs what is missing, and builds the programs
#   make test     the same with the tests, and passes them
#   make docs     the site of the pages, into out/docs
#   make archive  the sources of the present commit, into out/jointcreep-VERSION.tar.gz
#   make package  a Debian package, into build/release
#   make -C pipelines/NAME help   what a pipeline makes

VERSION := $(shell sed -n 's/.*VERSION \([0-9][0-9]*\.[0-9.]*\).*LANGUAGES.*/\1/p' CMakeLists.txt)

.PHONY: help build test docs archive package

help:
	@sed -n 's/^#   //p' Makefile
	@echo NAME: $(sort $(patsubst pipelines/%/Makefile,%,$(wildcard pipelines/*/Makefile)))

build:
	sh pipelines/setup.sh

test:
	sh pipelines/setup.sh test && ctest --preset test -j "$$(nproc)"

docs:
	sh pipelines/setup.sh docs

package:
	sh pipelines/setup.sh package

archive:
	mkdir -p out
	git archive --format=tar.gz --prefix=jointcreep-$(VERSION)/ -o out/jointcreep-$(VERSION).tar.gz HEAD
	@echo out/jointcreep-$(VERSION).tar.gz
