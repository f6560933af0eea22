#include "export/sha256.h"

#include <gtest/gtest.h>

#include "tests/support/data.h"

namespace quadsonde::product {
namespace {

// FIPS 180-4 examples, as published by NIST (SHA256.pdf of "Examples with Intermediate Values").
TEST(Sha256, GivesTheDigestsOfTheStandardsExamples) {
  EXPECT_EQ(sha256_hex(ingest::as_bytes("abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(sha256_hex(ingest::as_bytes("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(sha256_hex({}), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, GivesTheDigestOfAMillionLettersAInPiecesOfAnySize) {
  const std::string letters(1'000'000, 'a');
  for (const std::size_t piece : {1UL, 63UL, 64UL, 65UL, 4096UL}) {
    Sha256 hash;
    for (std::size_t at = 0; at < letters.size(); at += piece)
      hash.update(ingest::as_bytes(std::string_view(letters).substr(at, piece)));
    EXPECT_EQ(hash.hex(), "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0") << piece;
  }
}

TEST(Sha256, OfAFileIsThatOfItsBytesAndAMissingFileIsAProblem) {
  const support::TemporaryFolder folder;
  support::write_bytes(folder / "abc", {'a', 'b', 'c'});
  EXPECT_EQ(sha256_of_file(folder / "abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  const auto missing = sha256_of_file(folder / "nothing");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ingest::Kind::unreadable);
}

}  // namespace
}  // namespace quadsonde::product
