"""That matrix.py sees what it is there for: another hash, a program that fails, output that is none, a missing tool."""

import os
import subprocess
import sys

import matrix
import pytest

WANT = matrix.expected()


@pytest.fixture
def run(tmp_path):
    return matrix.Runner(str(tmp_path), "here", 1)


def program(folder, hashes, status=0):
    path = folder / "program.py"
    text = "".join(f"{name} {value}\n" for name, value in hashes.items())
    path.write_text(f"import sys\nsys.stdout.write({text!r})\nsys.stderr.write('what it says')\nsys.exit({status})\n")
    return [sys.executable, str(path)]


def test_the_same_is_the_same(run, tmp_path):
    run.scene("variant", program(tmp_path, WANT), ["--threads", "2"])
    assert not run.failed and run.rows[0]["hash"] == WANT["all"]


def test_another_hash_names_its_section(run, tmp_path):
    run.scene("variant", program(tmp_path, {**WANT, "waves": "0" * 16, "large": "0123456789abcdef", "all": "f" * 16}))
    assert run.failed and run.rows[0]["differs"] == ["large"]


@pytest.mark.parametrize("hashes", [{k: v for k, v in WANT.items() if k != "golden"}, {**WANT, "all": "f" * 16},
                                    {**WANT, "more": "f" * 16}, {}, {"maps": "short"}])
def test_output_that_is_not_all_of_it_fails(run, tmp_path, hashes):
    run.scene("variant", program(tmp_path, hashes))
    assert run.failed and run.rows[0]["differs"]


def test_a_program_that_fails_is_no_agreement(run, tmp_path):
    run.scene("variant", program(tmp_path, WANT, status=3))
    assert run.failed and "what it says" in run.rows[0]["differs"][0]


def script(tmp_path, group, **environment):
    return subprocess.run([sys.executable, "-B", os.path.join(matrix.HERE, "matrix.py"), "run", group, "--build",
                           str(tmp_path)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          env={"PATH": str(tmp_path), **environment})


@pytest.mark.parametrize("group", ["clang", "older", "arm64", "windows", "wasm"])
def test_a_missing_tool_is_a_skip_or_where_all_is_asked_for_a_failure(tmp_path, group):
    done = script(tmp_path, group)
    assert done.returncode == 77 and "SKIPPED" in done.stdout and "is not installed" in done.stdout, done.stdout
    done = script(tmp_path, group, FRM_DETERMINISM_REQUIRE="1")
    assert done.returncode == 1, done.stdout


def test_a_build_without_the_scene_fails(tmp_path):
    assert script(tmp_path, "here").returncode == 1


def test_every_section_is_expected():
    with open(os.path.join(matrix.HERE, "scene.c"), encoding="utf-8") as file:
        names = [line.split('"')[1] for line in file if line.startswith('    {"')]
    assert names == [name for name in WANT if name != "all"] and len(names) >= 18
