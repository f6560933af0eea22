"""Does packages/*.txt bring all that the build and the tests use, on a machine where nothing is installed?

    closure.py BUILD_FOLDER LIST...    e.g. closure.py build/dev build test

apt resolves the lists against an empty package state, together with what no Debian machine is without (the essential
packages, and apt); every file that used.py finds must belong to a package of that closure. Exit code 1 when one does
not, 77 (skipped) when the machine has no lists of packages.
"""

import os
import re
import subprocess
import sys

import used

EMPTY = ["-o", "Dir::State::status=/dev/null", "-o", "Dir::Cache::pkgcache=", "-o", "Dir::Cache::srcpkgcache=",
         "-o", "Debug::NoLocking=1", "-o", "APT::Install-Recommends=0"]
SKIPPED = 77


class Unresolved(Exception):
    """apt cannot install the lists; the text is its own."""


def listed(names):
    packages = []
    for name in names:
        text = (used.ROOT / "packages" / f"{name}.txt").read_text(encoding="utf-8")
        packages += [line.split("#")[0].strip() for line in text.splitlines() if line.split("#")[0].strip()]
    return packages


def apt_has_lists():
    return bool(subprocess.run(["apt-cache", "pkgnames", "build-essential"], capture_output=True, text=True,
                               check=False).stdout) and bool(used.output_of(
                                   ["apt-get", "indextargets", "--format", "$(FILENAME)", "Created-By: Packages"]))


def resolve(packages):
    """Names of all packages that an empty machine installs for these."""
    asked = subprocess.run(["apt-get", "--simulate", *EMPTY, "install", "?essential", "apt", *packages],
                           capture_output=True, text=True, check=False, env={**os.environ, "LC_ALL": "C"})
    if asked.returncode != 0:
        raise Unresolved(asked.stderr + asked.stdout)
    return set(re.findall(r"(?m)^Inst (\S+?)(?::\w+)? ", asked.stdout))


def candidates(link):
    """The files that the system of alternatives could let this link of it point to, as far as they are here."""
    asked = subprocess.run(["update-alternatives", "--list", os.path.basename(link)], capture_output=True, text=True,
                           check=False)
    return {os.path.realpath(path) for path in asked.stdout.split()} | {os.path.realpath(link)}


def steps(path):
    """The file and the links on the way to it: a list of sets, of each set one member must come with a package."""
    found = []
    while True:
        path = os.path.join(os.path.realpath(os.path.dirname(path)), os.path.basename(path))
        if path.startswith("/etc/alternatives/"):
            return found + [candidates(path)]
        found.append({path})
        if not os.path.islink(path):
            return found
        target = os.path.join(os.path.dirname(path), os.readlink(path))
        if target.startswith("/etc/alternatives/"):
            found.pop()  # the link itself is the alternatives' own, no package lists it
        path = target


def without_usr(path):
    return path[4:] if path.startswith(("/usr/lib", "/usr/bin/", "/usr/sbin/")) else path


def owners(paths):
    """{path: set of packages}; before the merge of /usr a package listed its file below / (dpkg still says so)."""
    spelled = {}
    for path in paths:
        spelled.setdefault(path, path)
        spelled.setdefault(without_usr(path), path)
    owned = {path: set() for path in paths}
    names = sorted(spelled)
    for at in range(0, len(names), 2000):
        asked = subprocess.run(["dpkg-query", "--search", *names[at:at + 2000]], capture_output=True, text=True,
                               check=False, env={**os.environ, "LC_ALL": "C"})
        for line in asked.stdout.splitlines():
            packages, _, path = line.partition(": ")
            if path in spelled and not packages.startswith("diversion by"):
                owned[spelled[path]] |= {package.split(":")[0] for package in packages.split(", ")}
    return owned


def missing(uses, closure):
    """One line for every used file that no package of the closure brings."""
    ways = {path: steps(path) if os.path.isabs(path) else [{path}] for path in uses}
    owned = owners({file for way in ways.values() for step in way for file in step})
    complaints = []
    for path, way in sorted(ways.items()):
        for step in way:
            packages = set().union(*(owned[file] for file in step))
            if not packages & closure:
                whose = f"is of {', '.join(sorted(packages))}" if packages else "belongs to no package"
                complaints.append(f"{path} (used by {uses[path]}) {whose}")
                break
    return complaints


def main():
    build, names = sys.argv[1], sys.argv[2:]
    if not apt_has_lists():
        print("skipped: needs apt's lists of packages (apt-get update)")
        return SKIPPED
    try:
        closure = resolve(listed(names))
    except Unresolved as problem:
        print(f"apt cannot install {' and '.join(names)} on an empty machine:\n{problem}")
        return 1
    uses = used.everything(build)
    complaints = missing(uses, closure)
    print("\n".join(complaints + [f"{len(uses)} files from outside the project, {len(closure)} packages, "
                                  f"{len(complaints)} files that no package of packages/*.txt brings"]))
    return 1 if complaints or not uses else 0


if __name__ == "__main__":
    sys.exit(main())
