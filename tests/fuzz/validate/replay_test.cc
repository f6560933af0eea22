#include "tests/fuzz/replay.h"

TEST(ValidateCorpus, IsJudgedWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 6u); }
