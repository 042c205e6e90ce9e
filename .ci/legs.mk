# The legs of .ci/run that need nothing of each other: two run side by side, and each shows what it said when it ends.
# One that fails ends it all. The longest come first, so that the last ones fill the gap.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.ONESHELL:
LEGS := validation pages speed site scenes lab demo
.PHONY: all $(LEGS)

all: $(LEGS)

validation:
	@kinsim validate --out "$(WORK)/validation"
	python .ci/claims.py --check "$(WORK)/validation"
	echo "--- $@: $$SECONDS s"

speed:
	@python benchmarks/run.py --quick --out "$(WORK)/benchmarks.json"
	cp docs/speed.md "$(WORK)"
	python .ci/tables.py "$(WORK)" "$(WORK)/speed.md"
	if cmp -s docs/speed.md "$(WORK)/speed.md"; then echo "docs/speed.md took no new table" && exit 1; fi
	python benchmarks/equal_error.py --quick
	echo "--- $@: $$SECONDS s"

site:
	@$(MAKE) --file Makefile docs
	python .ci/browser.py tests/site_in_browser.py
	echo "--- $@: $$SECONDS s"

pages:
	@python .ci/pages.py README.md docs/*.md docs/how-to/*.md
	echo "--- $@: $$SECONDS s"

scenes:
	@for scene in riemann silo silo-incline parabola sine; do
	    short="--quiet --set clock.steps=60"
	    kinsim run "$$scene" $$short --set method.velocity.count=32 --out "$(WORK)/$$scene.nc" --plot "$(WORK)/$$scene.png"
	    kinsim run "$$scene" $$short --method macroscopic --plot "$(WORK)/$$scene-macroscopic.png"
	    kinsim compare "$$scene" --set clock.steps=60 --set method.velocity.count=32 >/dev/null
	done
	for scene in bend bend-pressed exponential jump crest; do
	    short="--quiet --set clock.end=4 --set cells.count=64"
	    kinsim run "$$scene" $$short --set method.velocity.count=32 --out "$(WORK)/$$scene.nc" --plot "$(WORK)/$$scene.png"
	    kinsim compare "$$scene" --set clock.end=1 --set cells.count=64 --set method.velocity.count=32 >/dev/null
	done
	kinsim run rest-gallery --quiet --set clock.steps=60 --set method.velocity.count=32 --plot "$(WORK)/rest.png"
	kinsim animate bend --quiet --method macroscopic --set cells.count=64 --frames 5 -o "$(WORK)/bend.gif"
	python -m kinsim --version
	echo "--- $@: $$SECONDS s"

lab:
	@python .ci/browser.py tests/lab_in_browser.py
	python benchmarks/lab.py --seconds 3 --picture "$(WORK)/lab.png" --out "$(WORK)/lab.json"
	cp docs/how-to/lab.md "$(WORK)"
	python .ci/tables.py "$(WORK)" "$(WORK)/lab.md"
	if cmp -s docs/how-to/lab.md "$(WORK)/lab.md"; then echo "docs/how-to/lab.md took no new table" && exit 1; fi
	echo "--- $@: $$SECONDS s"

demo:
	@$(MAKE) --file Makefile demo
	test -s out/silo.nc && test -s out/silo.png
	echo "--- $@: $$SECONDS s"
