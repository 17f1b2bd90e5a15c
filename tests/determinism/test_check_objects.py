"""That check_objects.py sees what it is there for, and nothing where nothing is."""

import os
import shutil
import subprocess
import sys

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
FUSED = "float f(float a, float b, float c) { return a * b + c; }\n"
LOOP = "void f(float *a, const float *b, const float *c) { for (int i = 0; i < 64; ++i) a[i] = b[i] * c[i] - a[i]; }\n"
MACHINES = {
    "x86-64": (os.environ.get("FRM_CXX", "c++"), "objdump", "nm", ["-mavx2", "-mfma"]),
    "x86-64-avx512": (os.environ.get("FRM_CXX", "c++"), "objdump", "nm", ["-mavx512f", "-mfma"]),
    "arm64": ("aarch64-linux-gnu-g++", "aarch64-linux-gnu-objdump", "aarch64-linux-gnu-nm", []),
    "windows": ("x86_64-w64-mingw32-g++-posix", "x86_64-w64-mingw32-objdump", "x86_64-w64-mingw32-nm", ["-mavx2", "-mfma"]),
}


def check(folder, machine, source, flags):
    compiler, objdump, nm, always = MACHINES[machine]
    for tool in (compiler, objdump, nm):
        if not shutil.which(tool):
            pytest.skip(f"{tool} is not installed")
    (folder / "code.cpp").write_text(source)
    done = subprocess.run([compiler, "-O3", *always, *flags, "-c", "code.cpp", "-o", "code.o"], cwd=folder,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0 and "x86-64" in machine and os.uname().machine != "x86_64":
        pytest.skip("the compiler is for another machine")
    assert done.returncode == 0, done.stderr
    return subprocess.run([sys.executable, "-B", os.path.join(HERE, "check_objects.py"), "--objdump", objdump, "--nm", nm,
                           str(folder / "code.o")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("source", [FUSED, LOOP])
def test_fused_code_is_found(tmp_path, machine, source):
    done = check(tmp_path, machine, source, ["-ffp-contract=fast"])
    assert done.returncode == 1 and "fused multiply-add" in done.stdout, done.stdout


@pytest.mark.parametrize("machine", MACHINES)
@pytest.mark.parametrize("source", [FUSED, LOOP])
def test_nothing_is_found_without_contraction(tmp_path, machine, source):
    done = check(tmp_path, machine, source, ["-ffp-contract=off"])
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("machine", MACHINES)
def test_functions_of_the_c_library(tmp_path, machine):
    exact = check(tmp_path, machine, "#include <math.h>\nfloat f(float x) { return floorf(x) + sqrtf(x); }\n", [])
    assert exact.returncode == 0, exact.stdout
    for call in ("sinf(x)", "(float)pow(x, 0.3)", "expf(x)", "hypotf(x, 2)"):
        done = check(tmp_path, machine, f"#include <math.h>\nfloat f(float x) {{ return {call}; }}\n", [])
        assert done.returncode == 1 and "not exact" in done.stdout, done.stdout


def test_approximations_and_long_double_are_found(tmp_path):
    done = check(tmp_path, "x86-64", "#include <xmmintrin.h>\n__m128 f(__m128 x) { return _mm_rsqrt_ps(x); }\n", [])
    assert done.returncode == 1 and "reciprocal" in done.stdout, done.stdout
    done = check(tmp_path, "x86-64", "long double f(long double x) { return x * x + 1; }\n", [])
    assert done.returncode == 1 and "x87" in done.stdout, done.stdout


def test_what_cannot_be_checked_is_an_error(tmp_path):
    (tmp_path / "no.o").write_text("no object")
    done = subprocess.run([sys.executable, "-B", os.path.join(HERE, "check_objects.py"), "--objdump", "objdump", "--nm", "nm",
                           str(tmp_path / "no.o")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode not in (0,) and "cannot be checked" in done.stdout, done.stdout
