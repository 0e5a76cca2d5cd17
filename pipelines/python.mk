# What all pipelines share. Python: Debian's, which has h5py; it finds the package jointcreep, and what the plots share.
PYTHON := /usr/bin/python3
export PYTHONPATH := $(ROOT)/pipelines:$(ROOT)/pipelines/plots$(addprefix :,$(PYTHONPATH))

# Relative paths on the command line count from the folder in which make was called.
export CALLED_FROM ?= $(or $(PWD),$(CURDIR))
$(foreach variable,BIN OUT SCENE BENCHMARK PACE_BENCHMARK,$(if $(filter command,$(firstword $(origin $(variable)))),\
    $(if $(filter-out /%,$($(variable))),$(eval override $(variable) := $(abspath $(CALLED_FROM)/$($(variable)))))))

# What the Makefile does: the comment at its top.
.PHONY: help
help:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' $(firstword $(MAKEFILE_LIST))
.DEFAULT_GOAL :=
