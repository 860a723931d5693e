# A thin layer over CMake, for a fresh machine: `make` installs what is needed and builds, `make demo` shows what for.
# All targets: make help.

PREFIX ?= /usr/local
DESTDIR ?=
JOBS ?= 2

BIN = build/bin
DEMO = build/demo

.PHONY: all build configure dependencies dependencies-tests demo test install format clean help
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

test: dependencies-tests build ## builds and runs the tests; JOBS=n at a time (2)
	@ctest --preset release -j $(JOBS)

install: build ## installs under PREFIX (/usr/local), DESTDIR in front
	@DESTDIR="$(DESTDIR)" cmake --install build --prefix "$(PREFIX)"

format: ## formats the C and C++ sources with clang-format 14
	@find runtime bake tools tests assets -name '*.[ch]' -o -name '*.cpp' | xargs clang-format-14 -i

clean: ## removes everything that was built
	@rm -rf build

help: ## prints this
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-10s %s\n", $$1, $$2 }' Makefile
