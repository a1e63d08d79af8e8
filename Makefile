# make run        set up, then open a scene in a window; without a display, render every scene at
#                 four hours into out/
# make test       set up, then run the tests of the product
# make test-lab   set up, then run the tests of the laboratory (lab/)
# make docs       set up, then build the documentation as a site, out/site/index.html
# make dist       set up, then build sdist and wheel of the last commit into dist/, twice: they must
#                 be the same byte for byte
# make lint       set up, then ruff and mypy, of the versions that pyproject.toml pins
# make test-long  set up, then the tests that take long: the stability suite at 1.2e8 inputs, 1,000
#                 random sessions, an hour of play, two of a window's
# make clean      remove what running and testing made; .venv and .system stay
#
# Set-up makes .venv in the checkout and sees to system libraries: tools/bootstrap.sh says how.

BIN := .venv/bin
# Libraries fetched into the checkout are found through these variables.
WITH_SYSTEM := if [ -f .system/env ]; then . ./.system/env; fi;
# The tests run side by side, so each keeps to one core (LP: Mesa's llvmpipe).
ONE_CORE := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 LP_NUM_THREADS=1

.PHONY: run test test-lab lint docs dist test-long clean

run:
	@sh tools/bootstrap.sh run
	@$(WITH_SYSTEM) if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then $(BIN)/vrut-lite run; \
	else $(BIN)/vrut-lite demo --out out; fi

test:
	@sh tools/bootstrap.sh test
	@$(ONE_CORE) $(BIN)/python tests/compile_first.py
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest -n auto --maxprocesses 8 --dist worksteal \
		--durations=10 --durations-min=1

test-lab:
	@sh tools/bootstrap.sh test
	@$(ONE_CORE) $(BIN)/python tests/compile_first.py
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest lab/tests -n auto --maxprocesses 8 \
		--dist worksteal --durations=10 --durations-min=1

lint:
	@sh tools/bootstrap.sh lint
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

docs:
	@sh tools/bootstrap.sh docs
	@NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --quiet
	@echo 'built out/site/index.html'

dist:
	@sh tools/bootstrap.sh test
	@$(BIN)/python -m tools.make_dist

test-long:
	@sh tools/bootstrap.sh long
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest tests lab/tests -n auto -m long --long
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest -n auto --long tests/stress --stress-scale 20
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest \
		tests/recording/test_random_sessions.py --live-runs 1000
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest tests/test_soak.py --long --soak-minutes 60
	@$(WITH_SYSTEM) $(ONE_CORE) $(BIN)/python -m pytest lab/tests/test_memory_tour.py --long \
		--soak-minutes 120

clean:
	rm -rf out build dist lab/build .pytest_cache .hypothesis .mypy_cache .ruff_cache
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
