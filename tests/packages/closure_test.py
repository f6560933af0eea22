"""The check bites: what a list does not bring is reported, and what scripts and programs use is found."""

import ast
import sys
import unittest

import closure
import used

GEODESY = {"/usr/include/GeographicLib/LocalCartesian.hpp": "ingest/flight/local_frame.cc",
           "/usr/lib/x86_64-linux-gnu/libGeographicLib.so": "cli/quadsonde"}


@unittest.skipUnless(closure.apt_has_lists(), "needs apt's lists of packages (apt-get update)")
class Closure(unittest.TestCase):
    def test_a_package_taken_off_the_list_is_missed_by_its_header_and_its_library(self):
        packages = closure.listed(["build", "test"])
        self.assertEqual(closure.missing(GEODESY, closure.resolve(packages)), [])
        packages.remove("libgeographiclib-dev")
        complaints = closure.missing(GEODESY, closure.resolve(packages))
        self.assertEqual([complaint.split(" ")[0] for complaint in complaints], sorted(GEODESY))
        self.assertIn("used by ingest/flight/local_frame.cc) is of libgeographiclib-dev", complaints[0])

    def test_a_package_that_does_not_exist_is_told_in_the_words_of_apt(self):
        with self.assertRaisesRegex(closure.Unresolved, "no-such-package-anywhere"):
            closure.resolve(["no-such-package-anywhere"])


class Machine(unittest.TestCase):
    def test_a_file_of_no_package_is_reported(self):
        complaints = closure.missing({"/usr/local/include/handmade.h": "a.cc"}, {"libc6"})
        self.assertEqual(complaints, ["/usr/local/include/handmade.h (used by a.cc) belongs to no package"])

    def test_a_program_behind_the_merged_usr_and_a_link_finds_its_package(self):
        self.assertEqual(closure.missing({"/bin/bash": "", "/usr/bin/bash": ""}, {"bash"}), [])
        self.assertEqual(len(closure.missing({"/usr/bin/python3": ""}, {"python3-minimal"})), 1,
                         "the link's package is there, that of its target is not")

    def test_an_alternative_counts_when_one_that_could_be_chosen_is_there(self):
        self.assertEqual(closure.missing({"/usr/bin/awk": "tests/run.sh"}, {"mawk", "gawk"}), [])
        self.assertEqual(len(closure.missing({"/usr/bin/awk": "tests/run.sh"}, {"bash"})), 1)


class Scripts(unittest.TestCase):
    def test_programs_of_a_shell_script_are_found_where_a_command_can_stand(self):
        script = """#!/bin/bash
# not_this_one in a comment
set -e; first --flag | second && third || fourth
if ! fifth; then sixth; fi
words=(not_a_command); words+=(nor_this); SETTING=1 seventh "in $(eighth "and $(ninth)") quotes" 'not $(tenth)'
helper() { eleventh; }
helper; if command -v perhaps; then perhaps; fi
/usr/bin/twelfth build/own/program \\
  argument
env LC_ALL=C thirteenth << EOF
not_in_a_heredoc
EOF
case "$1" in
  pattern) fourteenth ;;
esac
"""
        self.assertEqual(used.called_by_shell(script),
                         {"first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth",
                          "eleventh", "/usr/bin/twelfth", "env", "thirteenth", "fourteenth"})

    def test_programs_and_modules_of_a_python_file_are_found(self):
        tree = ast.parse("import a.b\nfrom c import d\nfrom . import e\nsubprocess.run(['ninja', '-C'])\nrun([x])\n")
        self.assertEqual(list(used.called_by_python(tree)), ["ninja"])
        self.assertEqual(list(used.imported(tree)), ["a.b", "c"])


if __name__ == "__main__":
    result = unittest.main(exit=False).result
    if not result.wasSuccessful():
        sys.exit(1)
    if result.skipped:
        print(f"skipped: {result.skipped[0][1]}")
        sys.exit(closure.SKIPPED)
