# Python of the pipelines: Debian's, which has h5py; it finds the package jointcreep, and what the plots share.
PYTHON := /usr/bin/python3
export PYTHONPATH := $(ROOT)/pipelines:$(ROOT)/pipelines/plots$(addprefix :,$(PYTHONPATH))
