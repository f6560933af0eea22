#include "tests/fuzz/replay.h"

TEST(PaparazziCorpus, IsReadWithoutACrash) { EXPECT_GE(quadsonde::fuzz::replay(CORPUS), 5u); }
