# Every target installs the packages that it needs: missing Debian packages, and Python packages into .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= demo
SECONDS ?= 600
JOBS ?= $(shell nproc)
# Wheel to install. If WHEEL is empty, the package is built from its sources.
WHEEL ?=
PACKAGE := $(shell find cpp python cmake -type f -not -name '*.pyc') CMakeLists.txt pyproject.toml
EIGEN := /usr/include/eigen3/Eigen/Core:libeigen3-dev
GTEST := /usr/include/gtest/gtest.h:libgtest-dev
# Runtime library of clang++ for a sanitizer or the fuzzer, from a separate Debian package.
clang_library = $$(clang++ -print-file-name=libclang_rt.$(1)-$$(uname -m).a):libclang-rt-dev
BENCHMARK := /usr/include/benchmark/benchmark.h:libbenchmark-dev
CXX_SOURCES = $(shell find cpp python tests bench examples web ros2 -name '*.[ch]pp')

.DELETE_ON_ERROR:
.PHONY: help demo page test homes test-cpp test-python test-docs test-view clang sanitize nightly arm64 arm64-wheel windows macos cross firmware packages fuzz soak motions grasp inverse fastest torque streams dynamics peers lint \
        prose format stubs docs notebooks bench count stalls worst sdist wheel clean

help:
	@echo 'make demo             reproduce the paper: tables, figures and a report in ./$(OUT)'
	@echo 'make page             an interactive page with the library in WebAssembly: build/web/page.html'
	@echo 'make test             build and run the C++ tests and the Python tests'
	@echo 'make test-view        the tests of the viewer and the page; make test skips these tests without a browser'
	@echo 'make homes            fit capsules to the meshes of every robot of the tests, and try its home posture'
	@echo 'make clang, sanitize  the C++ tests with clang++, and under ASan and UBSan'
	@echo 'make arm64, windows   the C++ tests for 64-bit Arm under qemu, and for Windows under Wine'
	@echo 'make arm64-wheel      the Python package for 64-bit Arm, with its TESTS run under qemu'
	@echo 'make macos            the C++ tests and the Python extension for macOS, compiled and linked only'
	@echo 'make cross            a few motions on Arm and Windows, compared with this machine'
	@echo 'make firmware         a program for a bare Cortex-M7, run by qemu and compared with this machine'
	@echo 'make packages         the recipes for Conan and, with VCPKG_ROOT, for vcpkg'
	@echo 'make nightly          the C++ tests and a day of a control loop'
	@echo 'make soak             a day of a control loop at 1 kHz'
	@echo 'make motions          10,000 random motions of stacks of tasks: bounds, and rest'
	@echo 'make grasp            10,000 motions of a tray in two arms, and a few by Pink, Mink, PlaCo and roboplan'
	@echo 'make inverse          inverse kinematics: solved poses and times, compared with other libraries'
	@echo 'make fastest          motions in the least time: bounds, distance from the path, comparison with TOPP-RA'
	@echo 'make torque           random motions within bounds on torque, and the time that the bounds cost'
	@echo 'make streams          streams of joint postures with faults: bounds, delay, aborts by libfranka; compared with forwarders'
	@echo 'make dynamics         dynamics: errors relative to Pinocchio, and times'
	@echo 'make peers            the programs of docs/coming_from.md, in environments of their own'
	@echo 'make fuzz             look for input that breaks the tracker, for SECONDS=$(SECONDS)'
	@echo 'make lint             formatting, static analysis, imports, types, stubs, spelling, terms to avoid'
	@echo 'make prose            draw sentences to read: SEED=1 COUNT=20'
	@echo 'make bench            every benchmark, compared with the peers that are found; QUICK=1 for a first look'
	@echo 'make count            compare the instructions of each step with the recorded counts'
	@echo 'make worst            the longest ticks that a search has found; SEARCH=600 searches on'
	@echo 'make stalls           the loads of each step that wait for stores, compared with the recorded counts'
	@echo 'make format, stubs    format all sources and list the headers in fpbm.hpp; rewrite the Python stubs'
	@echo 'make docs             build the documentation in ./build/docs, with executed notebooks'
	@echo 'make notebooks        only the notebooks, executed, as .ipynb in ./build/notebooks'
	@echo 'make test-docs        run every code block of the README and the documentation'
	@echo 'make sdist, wheel     the source distribution; a wheel for Linux, built offline from the source distribution and tested'

demo: $(VENV)/package
	$(BIN)/fpbm-cpp reproduce --out $(OUT)
	@echo 'Report, tables and figures are in $(CURDIR)/$(OUT)'

page:
	tools/need.sh em++:emscripten npm $(EIGEN)
	web/build.sh build/web/page.html

test: test-cpp test-python

# LAWS=OFF omits the laws, for example in `make clang` after `make sanitize`: both use the same compiler.
test-cpp: preset = release
clang: preset = clang
sanitize: preset = sanitize
nightly: preset = nightly
test-cpp clang sanitize nightly:
	tools/need.sh g++ cmake git pkg-config ninja:ninja-build $(EIGEN) $(GTEST) $(if $(filter clang sanitize,$(preset)),clang++:clang)
	$(if $(filter sanitize,$(preset)),tools/need.sh $(call clang_library,asan))
	cmake --preset $(preset) $(if $(LAWS),-DFPBM_TEST_LAWS=$(LAWS))
	cmake --build --preset $(preset) --parallel $(JOBS)
	ctest --preset $(preset) --parallel $(JOBS)

# Other platforms, with cross compilers and emulators.
QEMU_ARM64 := qemu-aarch64 -L /usr/aarch64-linux-gnu
arm64 windows: preset = $@
arm64 windows: cross
	tools/need.sh cmake ninja:ninja-build $(EIGEN) /usr/src/googletest/CMakeLists.txt:googletest
	cmake --preset $(preset)
	cmake --build --preset $(preset) --parallel $(JOBS)
	WINEDEBUG=-all ctest --preset $(preset) --parallel $(JOBS)

# Few tests by default, because the emulated Python is slow. TESTS=tests/python runs all tests.
arm64-wheel: TESTS ?= $(addprefix tests/python/test_,resolver.py simulate.py model.py serial_arm.py track.py clearance.py)
arm64-wheel:
	tools/need.sh cmake ninja:ninja-build $(EIGEN) aarch64-linux-gnu-g++:g++-aarch64-linux-gnu qemu-aarch64:qemu-user
	PYTHON=$(PYTHON) tools/venv.sh $(VENV)
	PYTHON=$(BIN)/python tools/arm64_wheel.sh build/arm64-wheel $(TESTS)

# Zig has the libraries for linking macOS programs. The programs are not executed.
macos: $(VENV)/macos
	tools/need.sh cmake ninja:ninja-build $(EIGEN) /usr/src/googletest/CMakeLists.txt:googletest
	for preset in macos-aarch64 macos-x86_64; do \
	  export PATH="$(CURDIR)/$(BIN):$$PATH" && \
	  cmake --preset $$preset -DPython_EXECUTABLE=$(CURDIR)/$(BIN)/python -Dpybind11_DIR=$$(python -m pybind11 --cmakedir) \
	    -DPython_INCLUDE_DIR=$$(python -c 'import sysconfig; print(sysconfig.get_path("include"))') && \
	  cmake --build --preset $$preset --parallel $(JOBS) || exit 1; done

# Compares motions with the motions on this machine: bitwise equal on x86-64 under Windows, and equal up to round-off
# on Arm, where fused multiply-add rounds once.
cross:
	tools/need.sh g++ aarch64-linux-gnu-g++:g++-aarch64-linux-gnu qemu-aarch64:qemu-user \
	  x86_64-w64-mingw32-g++-posix:g++-mingw-w64-x86-64-posix wine:wine clang++:clang $(EIGEN)
	tests/cross/visual.sh tests/cross/motions.cpp
	mkdir -p build/cross
	$(MAKE) --no-print-directory -j $(JOBS) build/cross/here.txt build/cross/arm64.txt build/cross/windows.txt
	$(PYTHON) tests/cross/compare.py build/cross/here.txt build/cross/arm64.txt --double 1e-13 --float 1e-5
	$(PYTHON) tests/cross/compare.py build/cross/here.txt build/cross/windows.txt --double 0 --float 0

motions = $(1) -std=c++17 -O1 -Icpp/include -isystem /usr/include/eigen3 tests/cross/motions.cpp -o $(@:.txt=.out)
build/cross/here.txt: $(PACKAGE) tests/cross/motions.cpp
	$(call motions,g++)
	build/cross/here.out > $@
build/cross/arm64.txt: $(PACKAGE) tests/cross/motions.cpp
	$(call motions,aarch64-linux-gnu-g++)
	$(QEMU_ARM64) build/cross/arm64.out > $@
build/cross/windows.txt: $(PACKAGE) tests/cross/motions.cpp
	$(call motions,x86_64-w64-mingw32-g++-posix -static)
	WINEDEBUG=-all wine build/cross/windows.out > $@

packages: $(VENV)/packages
	tools/need.sh g++ cmake $(EIGEN)
	PATH="$(CURDIR)/$(BIN):$$PATH" packaging/try.sh build/packages

# The program on a Cortex-M7 without an operating system, in qemu, compared with the same program on this machine.
firmware:
	tools/need.sh g++ cmake arm-none-eabi-g++:gcc-arm-none-eabi qemu-system-arm $(EIGEN) \
	  /usr/lib/arm-none-eabi/newlib/nano.specs:libnewlib-arm-none-eabi \
	  /usr/lib/arm-none-eabi/newlib/libstdc++_nano.a:libstdc++-arm-none-eabi-newlib
	cmake -S examples/firmware -B build/firmware/board -DCMAKE_TOOLCHAIN_FILE=$(CURDIR)/examples/firmware/cortex_m7.cmake
	cmake -S examples/firmware -B build/firmware/host -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS=-O1
	cmake --build build/firmware/board
	cmake --build build/firmware/host
	$(PYTHON) tests/firmware/check.py build/firmware/board/firmware build/firmware/host/firmware

# A day at 1 kHz, or a given number of TICKS.
soak: TICKS ?= 8.64e7
soak:
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN) $(GTEST)
	cmake --preset release
	cmake --build --preset release --target fpbm_soak
	build/release/tests/cpp/fpbm_soak $(TICKS)

# Needs two hours of processor time.
motions: $(VENV)/package
	$(BIN)/python tests/soak/stack_motions.py

# Needs half an hour of processor time.
grasp: MOTIONS ?= 10000
grasp: $(VENV)/package
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN)
	cmake --preset bench
	cmake --build --preset bench --target bench_grasp
	$(BIN)/python bench/grasp_peers.py
	build/bench/bench/bench_grasp $(MOTIONS)

# Installs each library into an environment of its own, in build/inverse_peers. Needs a quarter of an hour.
inverse: $(VENV)/package $(VENV)/test $(VENV)/peers
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN)
	-tools/need.sh /usr/lib/python3/dist-packages/PyKDL$(call SUFFIX,/usr/bin/python3):python3-pykdl
	cmake --preset bench
	cmake --build --preset bench --target bench_inverse
	build/bench/bench/bench_inverse
	$(BIN)/python bench/inverse_peers.py --write
	$(BIN)/python bench/inverse_problems.py
	$(BIN)/python bench/inverse_clearance.py

# The table of docs/paths.md: motions in the least time, compared with TOPP-RA. Needs a few minutes.
fastest: $(VENV)/package $(VENV)/test
	$(BIN)/python -m pip install --quiet --no-compile --group toppra
	$(BIN)/python bench/fastest.py --count 170

# The tables of docs/torques.md: 12,000 random motions, and the price compared with TSID, which pip builds. Needs hours.
torque: $(VENV)/package $(VENV)/peers
	$(BIN)/python -m pip install --quiet --no-compile 'tsid>=1.10'
	$(BIN)/python bench/torque.py --count 12000 --price 200 --workers $(JOBS)

# A million chunks, and a day of an FR3 at 1 kHz. Needs hours.
streams: $(VENV)/package $(VENV)/test
	$(BIN)/python -m pip install --quiet --no-compile --group franka 'ruckig>=0.10'
	$(BIN)/python bench/streams.py --chunks 1000000 --guarded 100000 --hours 24 --count 400 --workers $(JOBS)

# The tables of docs/dynamics.md: robots from URDF files and random trees, compared with Pinocchio.
dynamics: $(VENV)/peers $(VENV)/bench
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN)
	cmake --preset bench -DFPBM_PINOCCHIO="$$(echo $(CURDIR)/$(VENV)/lib/python*/site-packages/cmeel.prefix)"
	cmake --build --preset bench --target bench_dynamics
	build/bench/bench/bench_dynamics $(VENV)/lib/python*/site-packages/cmeel.prefix/share/example-robot-data/robots \
	  $(VENV)/lib/python*/site-packages/ManipulaPy/ManipulaPy_data

# Programs of other libraries, compared with programs of this library. Each library is installed into build/stack_peers.
peers: $(VENV)/package $(VENV)/test
	-tools/need.sh /usr/lib/python3/dist-packages/PyKDL$(call SUFFIX,/usr/bin/python3):python3-pykdl
	FPBM_PEERS=build/stack_peers $(BIN)/python -m pytest tests/docs/test_coming_from.py -s

# The next run continues from the corpus in build/fuzz.
fuzz:
	tools/need.sh clang++:clang cmake ninja:ninja-build $(EIGEN)
	tools/need.sh $(call clang_library,fuzzer)
	cmake --preset fuzz
	cmake --build --preset fuzz --parallel $(JOBS)
	mkdir -p build/fuzz/corpus
	build/fuzz/tests/fuzz/tracker_fuzz -max_total_time=$(SECONDS) -max_len=1024 -len_control=0 -timeout=10 \
	  -verbosity=0 -print_funcs=0 -print_final_stats=1 -artifact_prefix=build/fuzz/ build/fuzz/corpus

test-python: $(VENV)/package $(VENV)/test $(VENV)/peers
	$(BIN)/python -m pytest -rs --numprocesses $(JOBS)

# Fits capsules to the meshes of every robot, and tests whether the home posture of each robot keeps the default margin.
homes: $(VENV)/package $(VENV)/test $(VENV)/peers
	FPBM_ALL_HOMES=1 $(BIN)/python -m pytest tests/python/test_home_postures.py tests/python/test_capsules.py --numprocesses $(JOBS)

test-view: page $(VENV)/package $(VENV)/test $(VENV)/browser
	tools/need.sh chromium
	$(BIN)/python -m pytest tests/python/test_view.py tests/python/test_view_robot.py tests/python/test_servo.py tests/python/test_page.py

lint: $(VENV)/package $(VENV)/lint
	tools/need.sh clang-format clang-tidy cmake ninja:ninja-build $(EIGEN) $(GTEST)
	clang-format --dry-run --Werror $(CXX_SOURCES)
	clang-tidy --quiet tools/umbrella.cpp -- -std=c++17 -I$(CURDIR)/cpp/include -isystem /usr/include/eigen3
	$(PYTHON) tools/headers.py --check
	$(PYTHON) tools/documented.py
	$(PYTHON) tools/prose.py check
	git ls-files -z | xargs -0 $(BIN)/codespell
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(BIN)/mypy --python-executable $(BIN)/python
	$(BIN)/python tools/stubs.py --check
	$(BIN)/python -m mypy.stubtest fpbm_cpp._core --mypy-config-file pyproject.toml --allowlist tools/stubtest.txt

# Prints random sentences from pages, comments and messages. SEED selects the sentences.
prose: SEED ?= 1
prose: COUNT ?= 20
prose:
	@$(PYTHON) tools/prose.py draw --seed $(SEED) --count $(COUNT)

format: $(VENV)/lint
	tools/need.sh clang-format
	$(PYTHON) tools/headers.py
	clang-format -i $(CXX_SOURCES)
	$(BIN)/ruff format .

stubs: $(VENV)/package $(VENV)/lint
	$(BIN)/python tools/stubs.py

docs: $(VENV)/package $(VENV)/docs
	tools/need.sh doxygen
	web/build.sh build/web/page.html
	mkdir -p build/doxygen
	doxygen docs/Doxyfile
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/python -m sphinx --builder html --fresh-env --fail-on-warning --keep-going --doctree-dir build/doctrees docs build/docs

notebooks: $(VENV)/package $(VENV)/docs
	mkdir -p build/notebooks
	for page in docs/notebooks/*.md; do \
	  $(BIN)/jupytext --quiet --to ipynb --output build/notebooks/$$(basename $$page .md).ipynb $$page; done
	$(BIN)/jupyter execute --inplace build/notebooks/*.ipynb

# `make test-cpp` builds the program that prints most figures of the pages; without it, these figures are skipped.
test-docs: $(VENV)/package $(VENV)/test $(VENV)/docs $(VENV)/peers
	tools/need.sh g++ cmake git $(EIGEN)
	$(BIN)/python -m pytest tests/docs -rs --numprocesses $(JOBS)

# After the build, all benchmarks need a quarter of an hour. QUICK=1 is less accurate, and needs one or two minutes.
bench: $(VENV)/package $(VENV)/test $(VENV)/bench
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN) $(BENCHMARK)
	-tools/need.sh valgrind /usr/include/kdl/chain.hpp:liborocos-kdl-dev
	cmake --preset bench -DFPBM_PINOCCHIO="$$(echo $(CURDIR)/$(VENV)/lib/python*/site-packages/cmeel.prefix)"
	cmake --build --preset bench --parallel $(JOBS)
	$(BIN)/python bench/run.py build/bench/bench $(if $(QUICK),--quick)

# Fails if a step has more instructions than recorded. RECORD=1 records the numbers.
count:
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN) valgrind
	cmake --preset bench
	cmake --build --preset bench --target bench_count
	$(PYTHON) bench/count.py build/bench/bench/bench_count $(if $(RECORD),--record)

# Times and instructions of the longest ticks that a search has found. SEARCH=600 continues the search for 600 s per
# case.
worst:
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN) $(BENCHMARK) valgrind
	cmake --preset bench
	cmake --build --preset bench --target bench_worst $(if $(SEARCH),bench_search_worst)
	$(if $(SEARCH),build/bench/bench/bench_search_worst python/fpbm_cpp/worst_motions.txt $(SEARCH) > build/bench/worst_motions.txt)
	$(if $(SEARCH),cp build/bench/worst_motions.txt python/fpbm_cpp/worst_motions.txt)
	build/bench/bench/bench_worst 50
	$(PYTHON) bench/worst.py build/bench/bench/bench_worst

# Fails if a step has more loads that wait for stores than recorded. RECORD=1 records the numbers. If make runs both
# `count` and `stalls`, `stalls` is second, because both compile the same program.
stalls: $(filter count,$(MAKECMDGOALS))
	tools/need.sh g++ cmake ninja:ninja-build $(EIGEN) valgrind
	cmake --preset bench
	cmake --build --preset bench --target bench_count
	$(PYTHON) bench/stalls.py build/bench/bench/bench_count $(if $(RECORD),--record)

sdist: $(VENV)/wheel
	tools/sdist.sh $(BIN)/python

wheel: sdist
	tools/need.sh g++
	tools/wheel.sh $(BIN)/python

clean:
	rm -rf build dist $(VENV) demo

# The package with its command line, and the packages of a dependency group in pyproject.toml. With --no-compile, pip
# does not compile all modules of a package. Python compiles a module at its first import, and the tests import few
# modules.
$(VENV)/package: $(PACKAGE)
	PYTHON=$(PYTHON) tools/venv.sh $(VENV)
	$(BIN)/python -m pip install '$(or $(WHEEL),.)[cli]'
	@touch $@

$(VENV)/test $(VENV)/lint $(VENV)/browser $(VENV)/docs: pyproject.toml | $(VENV)/package
	$(BIN)/python -m pip install --quiet --no-compile --group $(notdir $@)
	@touch $@

# Tools for distribution and cross-compilation do not need the installed package.
$(VENV)/wheel $(VENV)/macos $(VENV)/packages: pyproject.toml
	PYTHON=$(PYTHON) tools/venv.sh $(VENV)
	$(BIN)/python -m pip install --quiet --group $(notdir $@)
	@touch $@

# Other libraries for the benchmarks from Python. Unavailable libraries are skipped.
$(VENV)/bench: pyproject.toml | $(VENV)/package
	-for peer in pinocchio qp tsid toolbox pink mink; do $(BIN)/python -m pip install --quiet --group bench-$$peer; done
	@touch $@

# Other libraries for comparisons of arms and motions. If a library is unavailable, its tests are skipped. The tests use
# only the URDF files of ManipulaPy, and only the meshes of the packages after ManipulaPy. Therefore, these packages are
# installed without dependencies. Debian's PyKDL requires the Python version of Debian.
SUFFIX = $(shell $(1) -c 'import sysconfig; print(sysconfig.get_config_var("EXT_SUFFIX"))' 2> /dev/null)
$(VENV)/peers: pyproject.toml | $(VENV)/package
	-for group in peers franka; do $(BIN)/python -m pip install --quiet --no-compile --group $$group; done
	-$(BIN)/python -m pip install --quiet --no-compile --no-deps ManipulaPy==1.4.2 airo-models==0.0.12 rtb-data==2.0.0 robosuite==1.5.2
	-$(if $(filter $(call SUFFIX,/usr/bin/python3),$(call SUFFIX,$(BIN)/python)),\
	  tools/need.sh /usr/lib/python3/dist-packages/PyKDL$(call SUFFIX,$(BIN)/python):python3-pykdl)
	@touch $@
