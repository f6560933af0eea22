"""Counts what ctest wrote by --output-junit: the skipped tests by name and reason, then one plain closing line.

Exit code 1 when a test failed or none ran.
"""

import re
import sys
import xml.etree.ElementTree

NEEDS_DATA = re.compile(r"needs QUADSONDE_DATA: \S+")
REASON = re.compile(r"(?:: Skipped\n|skipped: )(.+)")  # GoogleTest's line, and that of the tests in Python


def count(root):
    """(passed, failed, skipped): the last two as lists of (name, output)."""
    passed, failed, skipped = 0, [], []
    for case in root.iter("testcase"):
        entry = (case.get("name"), case.findtext("system-out") or "")
        # ctest writes status run, fail or notrun; a skip is notrun with an element of that name, and so is
        # a program that is not there, which is a failure.
        if case.get("status") == "run":
            passed += 1
        elif case.find("skipped") is not None and "SKIP" in (case.find("skipped").get("message") or "").upper():
            skipped.append(entry)
        elif case.get("status") == "disabled":
            skipped.append(entry)
        else:
            failed.append(entry)
    return passed, failed, skipped


def report(passed, failed, skipped):
    lines = []
    without_data = [(name, found.group(0)) for name, output in skipped if (found := NEEDS_DATA.search(output))]
    if without_data:
        lines.append(f"{len(without_data)} skipped for missing QUADSONDE_DATA:")
        lines += [f"  {name}: {reason}" for name, reason in without_data]
    others = [(name, REASON.search(output)) for name, output in skipped if not NEEDS_DATA.search(output)]
    if others:
        lines.append(f"{len(others)} skipped for another reason:")
        lines += [f"  {name}: {found.group(1) if found else 'no reason given'}" for name, found in others]
    lines.append(f"{passed} passed, {len(failed)} failed, {len(skipped)} skipped")
    return lines


def main():
    counted = count(xml.etree.ElementTree.parse(sys.argv[1]).getroot())
    print("\n".join(report(*counted)))
    passed, failed, _ = counted
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
