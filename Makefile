# A thin face over the CMake presets. Needs nothing but make and git on Debian 12: each target installs what it misses.
PROGRAM := build/release/bin/soapfilm
JOBS := $(shell nproc)
# Further arguments to cmake when a build is configured for the first time, such as -DSOAPFILM_WERROR=ON.
CONFIGURE :=
SOURCES = find include src tools cli tests fuzz examples bench bindings web -name '*.h' -o -name '*.cpp'

.PHONY: help build demo test test-python wheel-portable test-wheel notebook fuzz docs test-docs web web-demo bench paper accuracy scenes adapt gallery deb test-deb format format-check tidy clean
.SUFFIXES:

help: ## list the targets
	@echo 'make TARGET, where TARGET is one of'
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  %-15s%s\n", $$1, $$2 }' Makefile

build: build-release ## the program, at build/release/bin/soapfilm

build-release build-dev: packages-viewer

build-opencl: packages-opencl

build-mpi: packages-mpi

demo: build ## scan a shape, reconstruct it, check it, draw both
	sh examples/demo.sh $(PROGRAM) out/demo

test: test-release ## release build and all tests (FULL=1: 100 000 degenerate clouds, not 2000)

test-asan: packages-asan ## the tests by clang, under AddressSanitizer and UndefinedBehaviorSanitizer
test-tsan: ## the tests under ThreadSanitizer, loops on std::thread, the portable platform
test-shared: ## an outside project links the shared library
test-mpi: ## runs by mpirun give the bytes of one process, and end together
test-opencl: ## the solve on an OpenCL device, by default PoCL's, gives the bits that it gives on the CPU

test-python: build-release packages-python ## the wheel of the Python package, installed, and its tests
	sh bindings/python/test.sh build/release out/python

notebook: test-python packages-notebook ## run the notebook of examples/python again, pictures included
	PYTHONPATH=$$(echo $(CURDIR)/out/python/venv/lib/python3*/site-packages) /usr/bin/python3 -m nbconvert \
	  --to notebook --execute --inplace \
	  --ExecutePreprocessor.record_timing=False examples/python/*.ipynb

test-viewer: build-release packages-viewer-test ## `soapfilm view` and `tiles` in headless Chromium; the validator of glTF
	sh viewer/test/run.sh $(PROGRAM) build/release/viewer out/viewer
	sh viewer/test/run.sh $(PROGRAM) build/release/viewer out/viewer tiles.test.mjs

web: build-release packages-web ## the program for browsers: out/web/index.html, one file (Emscripten); the npm package
	@test -f build/web/build.ninja || (cd web && emcmake cmake -S . -B ../build/web -G Ninja >/dev/null)
	NODE_PATH=/usr/share/nodejs cmake --build build/web --parallel $(JOBS)
	rm -rf out/web
	node web/build.mjs build/release/viewer/node_modules build/web/soapfilm.js out/web
	node web/package.mjs build/release/viewer/node_modules build/web/soapfilm.js out/web

web-demo: web ## serve it at http://localhost:8000
	node web/serve.mjs out/web 8000

test-web: web packages-viewer-test ## it gives the program's bytes, in node and Chromium
	node web/test/bytes.mjs $(PROGRAM) out/web/npm/soapfilm.mjs out/web-test
	node web/test/simplify.mjs $(PROGRAM) out/web/npm/soapfilm.mjs out/web-test
	node web/test/npm.mjs $(PROGRAM) out/web-test out/web/soapfilm-*.tgz
	SOAPFILM_PAGE=out/web/index.html sh viewer/test/run.sh $(PROGRAM) build/release/viewer out/web-test \
	  ../../web/test/web.test.mjs

test-%: build-%
	$(if $(FULL),SOAPFILM_FULL=1) ctest --preset $* --parallel $(JOBS) $(if $(FULL),--timeout 7200)

fuzz: packages-build packages-asan ## fuzz readers, parameters, the C interface (SECONDS=600 for each; FORMATS=.las: only these)
	@test -f build/asan/build.ninja || cmake --preset asan $(CONFIGURE)
	cmake --build --preset fuzz --parallel $(JOBS)
	sh fuzz/run.sh $(or $(SECONDS),600) $(FORMATS)

build-%: packages-build
	@test -f build/$*/build.ninja || cmake --preset $* $(CONFIGURE)
	cmake --build --preset $* --parallel $(JOBS)

bench: CONFIGURE += -DSOAPFILM_BUILD_BENCH=ON
bench: packages-build packages-bench ## measure speed beside peers, kernels, tolerance (SOAPFILM_DATA: folder with real scans)
	cmake --preset release $(CONFIGURE) >/dev/null && cmake --build --preset release --parallel $(JOBS)
	sh bench/run.sh build/release/bin out/bench
	/usr/bin/python3 -B bench/speed/speed.py build/release/bin out/bench

paper: CONFIGURE += -DSOAPFILM_BUILD_BENCH=ON
paper: packages-build packages-paper ## every table and figure of the paper, into docs/paper/ (SOAPFILM_DATA: as above)
	cmake --preset release $(CONFIGURE) >/dev/null && cmake --build --preset release --parallel $(JOBS)
	/usr/bin/python3 -B bench/paper/paper.py build/release/bin out/paper docs/paper

accuracy: build-release packages-accuracy ## errors against the truth, beside peers, to docs/accuracy/ (FULL=1: all)
	/usr/bin/python3 -B bench/accuracy/accuracy.py build/release/bin out/accuracy docs/accuracy \
	  --jobs $(JOBS) $(if $(FULL),--full)
	/usr/bin/python3 -B bench/accuracy/simplified.py build/release/bin out/accuracy docs/accuracy

scenes: build-release packages-scenes ## scenes as people scan them, beside a peer, to docs/scenes/ (SOAPFILM_DATA: as above)
	/usr/bin/python3 -B bench/scenes/scenes.py build/release/bin out/scenes docs/scenes --jobs $(JOBS)

adapt: build-release packages-scenes ## scenes with one voxel and with levels that adapt, to docs/notes/adapt.md
	/usr/bin/python3 -B bench/scenes/adapt.py build/release/bin out/adapt docs/notes/adapt.md

gallery: build-release packages-scenes ## the gallery of real scans, to docs/gallery/ and pages to turn to out/gallery/ (SOAPFILM_DATA: as above)
	/usr/bin/python3 -B docs/gallery/gallery.py build/release/bin/soapfilm out/gallery-work docs/gallery out/gallery

deb: packages-build packages-viewer packages-python packages-mpi packages-deb build-deb ## Debian packages into out/deb/
	rm -rf out/deb && cpack --config build/deb/CPackConfig.cmake -B out/deb
	rm -rf out/deb/_CPack_Packages
	lintian --fail-on error,warning out/deb/*.deb

wheel-portable: build-release packages-python packages-wheel ## the wheel with what it links inside, into out/wheel/
	sh packaging/wheel/build.sh build/release out/wheel

test-wheel: wheel-portable packages-test-deb ## install it where its libraries are not, and use it there
	sh packaging/test_wheel.sh out/wheel/*.whl out/wheel-test

test-deb: deb packages-test-deb ## install the Debian packages into a fresh Debian 12 and use them there
	sh packaging/test_deb.sh out/deb out/deb-test

format: packages-format ## lay the sources out
	$(SOURCES) | xargs clang-format -i

format-check: packages-format ## fail if `make format` would change anything
	$(SOURCES) | xargs clang-format --dry-run -Werror

docs: packages-docs ## the documentation as a site, to out/site/; its links are checked
	/usr/bin/python3 -B docs/site/stage.py out/site-pages && mkdocs build --strict --quiet && doxygen docs/site/Doxyfile
	/usr/bin/python3 -B docs/site/search.py out/site && /usr/bin/python3 -B docs/site/links.py out/site

test-docs: docs build-release packages-viewer-test ## its search, in headless Chromium
	sh viewer/test/run.sh $(PROGRAM) build/release/viewer out/site-test ../../docs/site/search.test.mjs

tidy: packages-tidy build-dev ## lint with clang-tidy
	find src tools cli -name '*.cpp' | xargs -n 1 -P $(JOBS) clang-tidy --quiet -p build/dev --extra-arg=-Wno-unknown-warning-option

clean: ## remove build/ and out/
	rm -rf build out

packages-%:
	@sh cmake/packages.sh $*
