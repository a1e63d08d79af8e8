# make run    set up, then open a scene in a window; without a display, render every scene at
#             four hours into out/
# make test   set up, then lint and run all tests
# make lint   set up, then ruff and mypy alone
# make stress set up, then the stability suite at length: 1.2e8 inputs, half an hour
# make clean  remove what running and testing made; .venv and .gl stay
#
# Set-up makes .venv in the checkout and sees to GL: tools/bootstrap.sh says how.

BIN := .venv/bin
# GL fetched into the checkout is found through these variables.
WITH_GL := if [ -f .gl/env ]; then . ./.gl/env; fi;
# The tests run side by side, so each keeps to one core.
ONE_CORE := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

.PHONY: run test lint stress clean

run:
	@sh tools/bootstrap.sh run
	@$(WITH_GL) if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then $(BIN)/vrut-lite run; \
	else $(BIN)/vrut-lite demo --out out; fi

test: lint
	@$(WITH_GL) $(ONE_CORE) $(BIN)/python -m pytest -n 2 --durations=10 --durations-min=1

lint:
	@sh tools/bootstrap.sh test
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy

stress:
	@sh tools/bootstrap.sh test
	@$(WITH_GL) $(ONE_CORE) $(BIN)/python -m pytest tests/stress --stress-scale 20

clean:
	rm -rf out build dist .pytest_cache .hypothesis .mypy_cache .ruff_cache
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
