# A thin layer over CMake, for a fresh machine: `make` installs what is needed and builds, `make demo` shows what for.
# All targets: make help.

PREFIX ?= /usr/local
DESTDIR ?=
JOBS ?= 2

BIN = build/bin
DEMO = build/demo
SOURCES = runtime bake tools tests assets docs/examples

.PHONY: all build configure dependencies dependencies-tests demo check test install format format-check clean help
.DEFAULT_GOAL := build

all: build ## the same as build

build: configure ## installs what is missing, configures, and compiles everything (the default)
	@cmake --build --preset release

dependencies:
	@tools/dependencies.sh

dependencies-tests:
	@tools/dependencies.sh tests

configure: dependencies
	@cmake --preset release --log-level=WARNING

demo: build ## makes the demo scene, compares the strategies on it, and says where the report is
	@$(BIN)/selvage-assets $(DEMO)
	@$(BIN)/selvage compare $(DEMO)/scene_faces.ptx --mesh $(DEMO)/scene.obj --focus creature --quick --out $(DEMO)/report
	@echo "The report: $(CURDIR)/$(DEMO)/report/report.html"

check: dependencies-tests build ## builds and runs the quick tests; JOBS=n at a time (2)
	@ctest --preset quick -j $(JOBS)

test: dependencies-tests build ## builds and runs the tests, long ones too with SELVAGE_TEST_EFFORT=1; JOBS=n at a time (2)
	@ctest --preset $(if $(SELVAGE_TEST_EFFORT),release,short) -j $(JOBS)

install: build ## installs under PREFIX (/usr/local), DESTDIR in front
	@DESTDIR="$(DESTDIR)" cmake --install build --prefix "$(PREFIX)"

format: ## formats the C and C++ sources with clang-format 14
	@find $(SOURCES) -name '*.[ch]' -o -name '*.cpp' | xargs clang-format-14 -i

format-check: ## says which sources are not formatted
	@find $(SOURCES) -name '*.[ch]' -o -name '*.cpp' | xargs clang-format-14 --dry-run -Werror

clean: ## removes everything that was built
	@rm -rf build

help: ## prints this
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile
