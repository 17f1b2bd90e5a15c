"""zstd's source tree, for targets that have no package of it: what `apt-get source libzstd` gives, by lists of sources that
this makes for itself from the system's own, so that nothing of the system changes. FRM_ZSTD_SOURCE in the environment
names another tree."""

import glob
import os
import re
import shutil
import subprocess
import tarfile


class Missing(Exception):
    """Why there is no source tree."""


def _source_lists(folder):
    """The system's package lists, asking for sources."""
    parts = os.path.join(folder, "sources.list.d")
    os.makedirs(parts)
    for path in ["/etc/apt/sources.list", *sorted(glob.glob("/etc/apt/sources.list.d/*"))]:
        if not os.path.isfile(path) or not path.endswith((".list", ".sources")):
            continue
        with open(path, encoding="utf-8") as file:
            text = file.read()
        if path.endswith(".sources"):
            text = re.sub(r"^Types:.*$", "Types: deb-src", text, flags=re.M)
        else:
            text = re.sub(r"^deb\s", "deb-src ", text, flags=re.M)
        name = os.path.basename(path) if "sources.list.d" in path else "system.list"
        with open(os.path.join(parts, name), "w", encoding="utf-8") as file:
            file.write(text)
    return parts


def _fetch(folder):
    apt = shutil.which("apt-get")
    if not apt:
        raise Missing("there is no apt-get to fetch zstd's source with; set FRM_ZSTD_SOURCE to its tree")
    parts = _source_lists(folder)
    for name in ("lists/partial", "cache/archives/partial", "download"):
        os.makedirs(os.path.join(folder, name))
    options = ["-q", "-o", "Dir::Etc::sourcelist=/dev/null", "-o", f"Dir::Etc::sourceparts={parts}",
               "-o", f"Dir::State::lists={folder}/lists", "-o", f"Dir::Cache={folder}/cache",
               "-o", "APT::Sandbox::User=", "-o", "Acquire::Retries=3"]
    for command in (["update"], ["source", "--download-only", "libzstd"]):
        done = subprocess.run([apt, *options, *command], cwd=os.path.join(folder, "download"), stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=600)
        # A list of somebody else's that has no sources fails the update, and does no harm.
        if done.returncode != 0 and command[0] == "source":
            raise Missing(f"apt-get source libzstd failed: {done.stdout.strip().splitlines()[-1]}")
    archives = glob.glob(os.path.join(folder, "download", "*.orig.tar.*[!c]"))
    if len(archives) != 1:
        raise Missing(f"apt-get source libzstd gave no archive of the source: {archives}")
    return archives[0]


def zstd_source(work):
    """The path of the tree, which is kept in `work`. Raises Missing."""
    given = os.environ.get("FRM_ZSTD_SOURCE")
    if given:
        if not os.path.exists(os.path.join(given, "lib", "zstd.h")):
            raise Missing(f"FRM_ZSTD_SOURCE: there is no lib/zstd.h in {given}")
        return os.path.abspath(given)
    tree = os.path.join(work, "zstd")
    if os.path.exists(os.path.join(tree, "lib", "zstd.h")):
        return tree
    folder = os.path.join(work, "zstd-fetch")
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    archive = _fetch(folder)
    with tarfile.open(archive) as tar:
        names = [m for m in tar.getmembers() if m.isfile() and "/lib/" in m.name and ".." not in m.name]
        tar.extractall(os.path.join(folder, "tree"), members=names)
    roots = glob.glob(os.path.join(folder, "tree", "*"))
    if len(roots) != 1 or not os.path.exists(os.path.join(roots[0], "lib", "zstd.h")):
        raise Missing(f"{archive} is not zstd's source")
    os.rename(roots[0], tree)
    shutil.rmtree(folder)
    return tree


if __name__ == "__main__":
    import sys
    print(zstd_source(os.path.abspath(sys.argv[1])))
