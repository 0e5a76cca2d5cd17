# From a scene to its results, and pictures that any scene has: what pipelines/slope and pipelines/shiplock share.
# The including Makefile says PYTHON, PLOTS, BIN, OUT, SCENE, STATES and FIELDS before; and if it wants them
#   WINDOW     the part of the section in pictures, as an option of plots
#   STRESSES   the range of the stresses' colours [MPa]

CHAIN := $(addprefix $(BIN)/,jointgen strength-averaging demsolve)

# A program that was built anew makes its file anew.
$(OUT)/network.h5: $(SCENE) $(BIN)/jointgen | $(OUT)
	$(BIN)/jointgen $< -o $@

$(OUT)/joints.h5: $(OUT)/network.h5 $(BIN)/strength-averaging
	$(BIN)/strength-averaging $< -o $@

$(OUT)/result.h5: $(OUT)/joints.h5 $(BIN)/demsolve
	$(BIN)/demsolve $< -o $@

$(OUT)/result-no-creep.h5: $(OUT)/joints.h5 $(BIN)/demsolve
	$(BIN)/demsolve $< --no-creep -o $@

$(OUT)/histories.csv $(OUT)/states.xdmf2: $(OUT)/result.h5 $(BIN)/jointexport
	$(BIN)/jointexport --quiet $< -o $@

$(OUT)/report.txt: $(SCENE) $(BIN)/jointgen | $(OUT)
	$(BIN)/jointgen $< --check --report > $@

$(OUT)/strength.png: $(OUT)/joints.h5 $(PLOTS)/plot_strength.py $(PLOTS)/figure.py
	$(PYTHON) $(PLOTS)/plot_strength.py $< -o $@

$(OUT)/blocks.png: $(OUT)/network.h5 $(PLOTS)/plot_blocks.py $(PLOTS)/figure.py
	$(PYTHON) $(PLOTS)/plot_blocks.py $< $(WINDOW) -o $@

$(OUT)/stereonet.png $(OUT)/rose.png $(OUT)/distributions.png: $(OUT)/%.png: $(OUT)/network.h5 \
    $(PLOTS)/plot_%.py $(PLOTS)/joint_sets.py $(PLOTS)/figure.py
	$(PYTHON) $(PLOTS)/plot_$*.py $< -o $@

STATE_PICTURES := $(foreach state,$(STATES),$(foreach field,$(FIELDS),$(OUT)/$(state)-$(field).png))

define state_picture
$(OUT)/$(1)-$(2).png: $(OUT)/result.h5 $(PLOTS)/plot_state.py $(PLOTS)/figure.py
	$(PYTHON) $(PLOTS)/plot_state.py $$< --state $(1) --field $(2) $(WINDOW) \
	    $(if $(filter stress,$(2)),$(if $(STRESSES),--range $(STRESSES))) -o $$@
endef
$(foreach state,$(STATES),$(foreach field,$(FIELDS),$(eval $(call state_picture,$(state),$(field)))))

$(OUT):
	mkdir -p $@

$(CHAIN) $(BIN)/jointexport $(BIN)/creepfit $(BIN)/jointcreep:
	$(error $@ is not built; first run: sh pipelines/setup.sh)
