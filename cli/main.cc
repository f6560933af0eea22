#include "cli/verb.h"

int main(int argc, char** argv) { return quadsonde::cli::run_program(argc, argv); }
