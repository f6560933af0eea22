"""What the build, the tests and the scripts take from the machine: files outside the project.

Each function returns {path: what uses it}.
"""

import ast
import importlib.util
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
NOT_OURS = {"build", "out", ".git"}
SYSTEM_PATH = "/usr/sbin:/usr/bin:/sbin:/bin"


def output_of(command, **options):
    return subprocess.run(command, check=True, capture_output=True, text=True, **options).stdout


def outside(path, *folders):
    return os.path.isabs(path) and not any(pathlib.Path(path).is_relative_to(folder) for folder in folders)


def project_files(accepts):
    for folder, folders, names in os.walk(ROOT):
        folders[:] = sorted(f for f in folders if f not in NOT_OURS and f != "__pycache__")
        for name in sorted(names):
            file = pathlib.Path(folder, name)
            if accepts(file):
                yield file


def headers(build):
    """What the compiler read, as ninja remembers it from the last build, and what CMake read to configure."""
    used, target = {}, ""
    for line in output_of(["ninja", "-C", str(build), "-t", "deps"]).splitlines():
        if line.startswith("    "):
            path = os.path.normpath(build / line.strip())
            if target and outside(path, ROOT, build):
                used.setdefault(path, target)
        elif line:
            target = line.split(":")[0] if line.endswith("(VALID)") else ""
    if not used:
        sys.exit(f"{build} remembers no header: build it first")  # else the check would pass on nothing
    for line in output_of(["ninja", "-C", str(build), "-t", "query", "build.ninja"]).splitlines():
        path = line.strip(" |")
        if outside(path, ROOT, build) and os.path.isfile(path):
            used.setdefault(path, "cmake")
    return used


def commands(build):
    """Programs and libraries that the commands of the build name by path or by -l."""
    used, by_name = {}, {}
    for line in output_of(["ninja", "-C", str(build), "-t", "commands"]).splitlines():
        words = shlex.split(line)
        compiler = next((w for w in words if w.endswith(("/c++", "/clang++", "/g++"))), None)
        target = words[words.index("-o") + 1] if "-o" in words[:-1] else "a command of the build"
        for word in words:
            if outside(word, ROOT, build) and os.path.isfile(word):
                used.setdefault(word, target)
            elif re.fullmatch(r"-l[\w+.-]+", word) and compiler:
                by_name.setdefault((compiler, word[2:]), target)
    for (compiler, name), target in by_name.items():
        found = [output_of([compiler, f"-print-file-name=lib{name}.{ending}"]).strip() for ending in ("so", "a")]
        used[next((path for path in found if os.path.isabs(path)), f"-l{name}")] = target
    return used


def built_programs(build):
    for folder, folders, names in os.walk(build):
        folders[:] = [f for f in folders if f not in ("CMakeFiles", "Testing")]
        for name in names:
            path = os.path.join(folder, name)
            if os.access(path, os.X_OK) and not os.path.islink(path):
                with open(path, "rb") as file:
                    if file.read(4) == b"\x7fELF":
                        yield path


def loaded_libraries(build):
    """What the dynamic linker loads for each program that was built."""
    used = {}
    for program in built_programs(build):
        for line in output_of(["ldd", program]).splitlines():
            found = re.search(r"(?:=> )?(/\S+) \(0x", line)
            if found and outside(found.group(1), ROOT, build):
                used.setdefault(found.group(1), os.path.relpath(program, build))
            elif "not found" in line:
                used.setdefault(line.split()[0], os.path.relpath(program, build))
    return used


def test_programs(build):
    listed = json.loads(output_of(["ctest", "--test-dir", str(build), "--show-only=json-v1"]))
    return {test["command"][0]: f"the test {test['name']}" for test in listed["tests"]
            if "command" in test and outside(test["command"][0], ROOT, build)}


def without_strings(script):
    """The script with comments, heredocs and quoted text blanked; what $( ) calls inside quotes stays."""
    script = re.sub(r"<<-?\s*(['\"]?)(\w+)\1([^\n]*)\n(?:.*?\n)?\s*\2\n", r"\3\n", script, flags=re.DOTALL)
    script = re.sub(r"(?m)(^|\s)#.*$", r"\1", script.replace("\\\n", " "))
    kept, quotes, at = [], [""], 0  # quotes: what each open $( ) stands in
    while at < len(script):
        char, quote = script[at], quotes[-1]
        if quote != "'" and script.startswith("$(", at):
            quotes.append("")
            kept.append("\n(")
            at += 1
        elif not quote and char == ")" and len(quotes) > 1:
            quotes.pop()
            kept.append(" )_")
        elif char == "\\":
            at += 1
        elif char in "\"'" and quote in ("", char):
            quotes[-1] = "" if quote else char
            kept.append("_")
        elif not quote:
            kept.append(char)
        at += 1
    return "".join(kept)


def called_by_shell(script):
    """Names at command position that are neither builtins nor functions nor asked for by command -v."""
    text = without_strings(script)
    function = r"(?m)^\s*(?:function\s+)?([\w-]+)\s*\(\)"
    own = set(re.findall(function, text))
    for sourced in re.findall(r"(?m)^\s*(?:source|\.)\s+(.+)$", script):
        # Functions of a script that this one reads in; its folder may stand in a variable, its name does not.
        name = sourced.strip().strip("\"'").split("/")[-1]
        for path in ROOT.rglob(name):
            if "build" not in path.relative_to(ROOT).parts:
                own |= set(re.findall(function, path.read_text(encoding="utf-8")))
    own |= set(output_of(["bash", "-c", "compgen -b; compgen -k"]).split())
    optional = set(re.findall(r"\bcommand -v\s+([\w.+-]+)", text))
    lead = r"(?:(?:if|then|elif|else|while|until|do|time|exec|env|\{|!)\s+|\w+=[^\s()]*\s+)*"
    start = r"(?:^|^[ \t]*[\w|*.-]+\)|&&|\|\|?|;|(?<!=)\(|\)[ \t]*\{)[ \t]*"
    at_command = re.compile(start + lead + r"(/?[A-Za-z][\w./+-]*)(?![\w+=(\[)])", re.MULTILINE)
    called = set(at_command.findall(text)) | ({"env"} if re.search(r"\benv\s+\w+=", text) else set())
    return {name for name in called if name not in own | optional and ("/" not in name or name.startswith("/"))}


def called_by_python(tree):
    """Programs that a list given to subprocess.run and its kin, or to output_of, names first."""
    runs = {"run", "check_output", "check_call", "call", "Popen", "output_of"}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call) or getattr(node.func, "attr", getattr(node.func, "id", "")) not in runs:
            continue
        listed = node.args[0].elts if node.args and isinstance(node.args[0], ast.List) else []
        if listed and isinstance(listed[0], ast.Constant) and isinstance(listed[0].value, str):
            yield listed[0].value


def scripts_programs():
    """Programs that the project's shell and Python files call; by name, as the system's own path finds them."""
    used = {}
    for file in project_files(lambda f: f.suffix == ".sh" or f == ROOT / ".ci" / "run"):
        for name in called_by_shell(file.read_text(encoding="utf-8")):
            used.setdefault(shutil.which(name, path=SYSTEM_PATH) or name, str(file.relative_to(ROOT)))
    for file in project_files(lambda f: f.suffix == ".py"):
        for name in called_by_python(ast.parse(file.read_text(encoding="utf-8"))):
            used.setdefault(shutil.which(name, path=SYSTEM_PATH) or name, str(file.relative_to(ROOT)))
    return used


def imported(tree):
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module


def origin_of(module):
    try:
        spec = importlib.util.find_spec(module)
    except ModuleNotFoundError:
        spec = None
    return spec.origin if spec and spec.origin else f"import {module}"


def python_modules():
    """The file of every module that the project's Python files import (the interpreter, for one built into it)."""
    used = {}
    for file in project_files(lambda f: f.suffix == ".py"):
        for module in set(imported(ast.parse(file.read_text(encoding="utf-8")))):
            if (file.parent / (module.split(".")[0] + ".py")).exists():
                continue
            origin = origin_of(module)
            path = sys.executable if origin in ("built-in", "frozen") else origin
            used.setdefault(path, f"{file.relative_to(ROOT)} imports {module}")
    return used


def everything(build):
    build = pathlib.Path(build).resolve()
    used = {}
    for part in (headers(build), commands(build), loaded_libraries(build), test_programs(build), scripts_programs(),
                 python_modules()):
        used.update({path: user for path, user in part.items() if path not in used})
    return used
