"""frm bake loses nothing: interrupted, killed, on a full disk, twice at once; and its tasks solved one by one."""
import json
import os
import resource
import shutil
import signal
import subprocess
import time

import pytest

from conftest import PROGRAM, names

# Six flows of a fraction of a second each.
OPTIONS = ["--directions", "6", "--no-symmetry", "--sources", "6", "--resolution", "4", "--quality", "draft"]


@pytest.fixture(scope="module")
def whole(good, box, tmp_path_factory):
    """The map of a bake that nothing happened to."""
    path = tmp_path_factory.mktemp("whole") / "box.frm"
    good("bake", box, "-o", path, *OPTIONS)
    return path.read_bytes()


def start(box, out, *more, **others):
    return subprocess.Popen([PROGRAM, "bake", str(box), "-o", str(out), *OPTIONS, *more], text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, **others)


def flows(out):
    return sorted(out.parent.glob(out.name + ".work/*/task-*.flow"))


def wait_for_flows(out, count, process):
    end = time.monotonic() + 60
    while len(flows(out)) < count and time.monotonic() < end:
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL, signal.SIGHUP])
def test_what_is_done_stays_and_the_same_command_goes_on(good, box, whole, tmp_path, number):
    out = tmp_path / "box.frm"
    process = start(box, out, "--threads", "1")
    wait_for_flows(out, 2, process)
    process.send_signal(number)
    said, error = process.communicate(timeout=100)
    assert process.returncode != 0 and said == "" and not out.exists()
    kept = {path: path.stat().st_mtime_ns for path in flows(out)}
    assert 2 <= len(kept) < 6
    if number in (signal.SIGINT, signal.SIGTERM):
        assert f"{len(kept)} of 6 flows are kept in" in error and "the same command goes on" in error
        # A flow that was running leaves nothing.
        assert names(flows(out)[0].parent) == ["locks", "plan.json"] + sorted(path.name for path in kept)
    outcome = good("bake", box, "-o", out, *OPTIONS, "--keep")
    assert f"going on: {len(kept)} of 6 flows" in outcome.err
    assert out.read_bytes() == whole
    assert all(path.stat().st_mtime_ns == then for path, then in kept.items())  # not solved again
    # All are there: the map is made of them at once, and the folder goes.
    out.unlink()
    assert "6 of 6" in good("bake", box, "-o", out, *OPTIONS).err
    assert out.read_bytes() == whole and names(tmp_path) == ["box.frm"]


def test_an_interrupt_before_the_first_flow_leaves_nothing(box, tmp_path):
    process = subprocess.Popen([PROGRAM, "bake", str(box), "-o", str(tmp_path / "b.frm"), "--threads", "1"], text=True,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    for line in process.stderr:
        if "%, " in line:
            break
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=100)
    assert process.returncode == 1 and out == "" and "interrupted; no flow was finished" in err
    assert names(tmp_path) == []


def test_two_at_once_share_the_work(box, whole, tmp_path):
    out = tmp_path / "box.frm"
    one = start(box, out, "--threads", "1", "--keep")
    wait_for_flows(out, 1, one)
    two = start(box, out, "--threads", "1")
    for process in (one, two):
        said, error = process.communicate(timeout=200)
        assert process.returncode == 0, error
        assert "box.frm" in said and "solved again" not in error
    assert out.read_bytes() == whole
    # The second could not take away what the first was to keep, or did so after it.
    assert names(tmp_path) in (["box.frm"], ["box.frm", "box.frm.work"])


def test_one_goes_on_with_what_the_killed_other_was_at(box, whole, tmp_path):
    out = tmp_path / "box.frm"
    one = start(box, out, "--threads", "1")
    wait_for_flows(out, 2, one)
    two = start(box, out, "--threads", "1")
    wait_for_flows(out, 3, one)
    one.kill()
    one.communicate()
    said, error = two.communicate(timeout=200)
    assert two.returncode == 0, error
    assert out.read_bytes() == whole and names(tmp_path) == ["box.frm"]


def test_other_options_keep_their_own_hours(good, box, whole, tmp_path):
    out = tmp_path / "box.frm"
    process = start(box, out, "--threads", "1")
    wait_for_flows(out, 2, process)
    process.terminate()
    process.communicate()
    kept = flows(out)
    outcome = good("bake", box, "-o", out, *OPTIONS, "--speed", "1")
    assert "going on" not in outcome.err and "unfinished bake with other options" in outcome.err
    assert flows(out) == kept and out.read_bytes() != whole
    good("bake", box, "-o", out, *OPTIONS)
    assert out.read_bytes() == whole and names(tmp_path) == ["box.frm"]


def test_damaged_and_foreign_flows_are_solved_again(good, box, whole, tmp_path):
    out = tmp_path / "box.frm"
    good("bake", box, "-o", out, *OPTIONS, "--keep")
    out.unlink()
    files = flows(out)
    content = files[1].read_bytes()
    files[1].write_bytes(content[:50] + bytes([content[50] ^ 1]) + content[51:])
    files[2].write_bytes(b"")
    shutil.copy(files[3], files[4])
    outcome = good("bake", box, "-o", out, *OPTIONS)
    assert outcome.err.count("is solved again") == 3
    assert out.read_bytes() == whole and names(tmp_path) == ["box.frm"]


def small_files():
    resource.setrlimit(resource.RLIMIT_FSIZE, (6000, resource.RLIM_INFINITY))


def test_a_file_that_does_not_fit_leaves_nothing(good, box, whole, tmp_path):
    out = tmp_path / "box.frm"
    # Python ignores SIGXFSZ, and so does what it starts then.
    process = start(box, out, preexec_fn=small_files, restore_signals=False)
    said, error = process.communicate(timeout=200)
    assert process.returncode == 1 and "File too large; no flow was finished" in error, error
    assert names(tmp_path) == []
    # Now the flows are there and the map does not fit.
    good("bake", box, "-o", out, *OPTIONS, "--keep")
    out.unlink()
    process = start(box, out, preexec_fn=small_files, restore_signals=False)
    said, error = process.communicate(timeout=200)
    assert process.returncode == 1 and "File too large; 6 of 6 flows are kept" in error, error
    assert names(tmp_path) == ["box.frm.work"]
    good("bake", box, "-o", out, *OPTIONS)
    assert out.read_bytes() == whole and names(tmp_path) == ["box.frm"]


def test_a_full_disk_loses_nothing(good, box, whole, tmp_path):
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "none", str(disk)], capture_output=True).returncode:
        pytest.skip("a small disk cannot be mounted here")
    try:
        out = disk / "box.frm"
        process = start(box, out)
        said, error = process.communicate(timeout=200)
        assert process.returncode == 1 and "No space left on device" in error and "flows are kept in" in error, error
        assert not out.exists() and not [path for path in disk.rglob("*") if ".tmp" in path.name]
        kept = {path: path.stat().st_mtime_ns for path in flows(out)}
        assert 0 < len(kept) < 6
        subprocess.run(["mount", "-o", "remount,size=4m", str(disk)], check=True)
        good("bake", box, "-o", out, *OPTIONS, "--keep")
        assert out.read_bytes() == whole
        assert all(path.stat().st_mtime_ns == then for path, then in kept.items())
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_work_elsewhere(good, box, whole, tmp_path):
    out = tmp_path / "box.frm"
    good("bake", box, "-o", out, *OPTIONS, "--work", tmp_path / "work", "--keep")
    assert names(tmp_path) == ["box.frm", "work"] and len(list((tmp_path / "work").glob("*/*.flow"))) == 6
    assert out.read_bytes() == whole


# ---- plan, solve, merge ----


@pytest.fixture
def planned(good, box, tmp_path):
    """A folder of 6 tasks that was moved after it was planned."""
    outcome = good("bake", "plan", box, "-o", tmp_path / "made", *OPTIONS, "--json")
    assert outcome.json["tasks"] == 6 and outcome.json["missing"] == "0-5" and outcome.json["updates"] > 1e6
    (tmp_path / "made").rename(tmp_path / "jobs")
    return tmp_path / "jobs"


def solve(folder, *more, **environment):
    return subprocess.run([PROGRAM, "bake", "solve", str(folder), *more], text=True, capture_output=True, timeout=200,
                          env={**os.environ, **environment})


def test_tasks_one_by_one_and_merged_are_the_local_map(frm, good, refused, box, planned, whole, tmp_path):
    out = tmp_path / "box.frm"
    outcome = frm("bake", "merge", planned, "-o", out)
    assert outcome.status == 3 and outcome.out == "0-5\n" and "6 of 6 tasks" in outcome.err
    assert "task 1 (direction 0.00 -1.00 0.00): done" in good("bake", "solve", planned, "--task", 1).out
    assert "task 3 " in solve(planned, SLURM_ARRAY_TASK_ID="3").stdout
    assert "there already" in good("bake", "solve", planned, "--task", 1).err
    refused(1, "--task 6|0 to 5|0,2,4-5", "bake", "solve", planned, "--task", 6)
    outcome = frm("bake", "merge", planned, "-o", out)
    assert outcome.status == 3 and outcome.out == "0,2,4-5\n" and not out.exists()
    assert len(good("bake", "solve", planned).out.splitlines()) == 4
    # A lost task, and a damaged one.
    (planned / "task-00002.flow").unlink()
    with open(planned / "task-00004.flow", "r+b") as file:
        file.truncate(64)
    outcome = frm("bake", "merge", planned, "-o", out)
    assert outcome.status == 3 and outcome.out == "2,4\n" and "task-00004.flow" in outcome.err
    again = good("bake", "plan", box, "-o", planned, *OPTIONS, "--json")
    assert again.json["missing"] == "2,4" and "task-00004.flow" in again.err
    for task in (2, 4):
        good("bake", "solve", planned, "--task", task)
    assert good("bake", "merge", planned, "-o", out, "--json").json["mlups"] is None  # nothing was solved
    assert out.read_bytes() == whole
    assert len(list(planned.glob("*.flow"))) == 6  # what was solved stays


def test_processes_of_a_launcher_share_the_tasks(good, planned, whole, tmp_path):
    ranks = [subprocess.Popen([PROGRAM, "bake", "solve", str(planned)], text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, env={**os.environ, "PMI_RANK": str(rank), "PMI_SIZE": "3"})
             for rank in range(3)]
    done = []
    for rank in ranks:
        out, err = rank.communicate(timeout=200)
        assert rank.returncode == 0, err
        done += [int(line.split()[1]) for line in out.splitlines()]
    assert sorted(done) == list(range(6))  # each once
    good("bake", "merge", planned, "-o", tmp_path / "box.frm")
    assert (tmp_path / "box.frm").read_bytes() == whole


def test_a_folder_holds_all_it_needs(good, refused, tmp_path, box):
    """A .gltf with its data in another file; a mesh that was changed afterwards."""
    data = box.read_bytes()
    size = int.from_bytes(data[12:16], "little")
    text = json.loads(data[20:20 + size])
    (tmp_path / "a" / "parts").mkdir(parents=True)
    (tmp_path / "a" / "parts" / "data.bin").write_bytes(data[28 + size:])
    text["buffers"][0]["uri"] = "parts/data.bin"
    (tmp_path / "a" / "box.gltf").write_text(json.dumps(text))
    good("bake", "plan", tmp_path / "a" / "box.gltf", "-o", tmp_path / "jobs", *OPTIONS)
    good("bake", "plan", tmp_path / "a" / "box.gltf", "-o", tmp_path / "jobs", *OPTIONS)  # again: the same plan
    good("bake", tmp_path / "a" / "box.gltf", "-o", tmp_path / "local.frm", *OPTIONS)
    shutil.rmtree(tmp_path / "a")
    good("bake", "solve", tmp_path / "jobs")
    (tmp_path / "here").mkdir()
    good("bake", "merge", tmp_path / "jobs", cwd=tmp_path / "here")
    assert (tmp_path / "here" / "box.frm").read_bytes() == (tmp_path / "local.frm").read_bytes()
    refused(1, "box.frm|already there", "bake", "merge", tmp_path / "jobs", cwd=tmp_path / "here")
    refused(1, "another bake", "bake", "plan", box, "-o", tmp_path / "jobs", *OPTIONS)
    with open(tmp_path / "jobs" / "mesh" / "parts" / "data.bin", "r+b") as file:
        file.write(b"\0\0\0\x3f")
    refused(1, "plan again", "bake", "solve", tmp_path / "jobs")


def test_nothing_of_others_is_written_over(refused, tmp_path, box):
    """Before anything is solved."""
    (tmp_path / "jobs").mkdir()
    (tmp_path / "jobs" / "plan.json").write_text('{"my": "plan"}')
    refused(1, "plan.json|not a plan of frm bake", "bake", "plan", box, "-o", tmp_path / "jobs", *OPTIONS)
    assert (tmp_path / "jobs" / "plan.json").read_text() == '{"my": "plan"}'
    (tmp_path / "notes.txt").write_text("mine")
    refused(1, "--raw|notes.txt|no raw tables", "bake", box, "-o", "a.frm", "--raw", "notes.txt", *OPTIONS, cwd=tmp_path)
    assert (tmp_path / "notes.txt").read_text() == "mine"
    for other in ("--work", "--report"):
        refused(1, "a.frm|two outputs", "bake", box, "-o", "a.frm", other, "a.frm", *OPTIONS, cwd=tmp_path)
    assert names(tmp_path) == ["jobs", "notes.txt"]


def test_raw_tables_of_a_merged_map(good, tmp_path, box):
    good("bake", "plan", box, "-o", tmp_path / "jobs", *OPTIONS)
    good("bake", "solve", tmp_path / "jobs")
    good("bake", "merge", tmp_path / "jobs", "-o", tmp_path / "a.frm", "--raw", tmp_path / "a.frmraw")
    assert "as stated" in good("verify", tmp_path / "a.frm", "--against", tmp_path / "a.frmraw").out


def test_wrong_folders_and_words(refused, tmp_path, box):
    refused(1, "plan.json|frm bake plan", "bake", "solve", tmp_path)
    refused(1, "plan.json", "bake", "merge", tmp_path, "-o", tmp_path / "b.frm")
    (tmp_path / "plan.json").write_text("{}")
    refused(1, "plan.json|not a plan", "bake", "solve", tmp_path)
    refused(2, "--task|-1", "bake", "solve", tmp_path, "--task", "-1")
    refused(2, "frm bake plan|MESH", "bake", "plan", "-o", tmp_path / "jobs")
    refused(2, "--quality|after plan", "bake", "--quality", "high", "plan", box, "-o", tmp_path / "jobs")
    # A mesh by the name of a sub-command.
    refused(1, "./plan|no such file", "bake", "./plan", "-o", tmp_path / "b.frm", cwd=tmp_path)
    assert names(tmp_path) == ["plan.json"]
