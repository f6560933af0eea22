#include "tests/fuzz/replay.h"

TEST(UlogCorpus, IsReadWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 5u); }
