#pragma once
// Any BUFR message as its elements and their values.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ingest/flight/bytes.h"
#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// One element of a message in its place: a value, or one of each subset where the subsets differ.
struct BufrValues {
  int code = 0;  ///< F XX YYY without F, as 11001
  bool is_text = false;
  bool text_missing = false;                  ///< of a text: all subsets have none
  std::vector<std::optional<double>> values;  ///< in the units of Table B; empty: missing. Of a text: none
};

/// In the order of the message. Operators, replication factors and the bits of quality information are among them.
using BufrContent = std::vector<BufrValues>;

/// Decodes by ecCodes in a child process with limits on memory and time (export/isolated.h).
/// @param message  from BUFR to 7777
/// Fails with Kind::damaged where ecCodes cannot decode it or dies of it, Kind::limit where it takes too long, and
/// Kind::no_answer where there is no process to be had.
ingest::Result<BufrContent> decode_bufr(ingest::Bytes message);

/// The content on its way out of the child, and back; empty for bytes that are none.
std::string pack(const BufrContent& content);
std::optional<BufrContent> unpack_content(std::string_view packed);

}  // namespace quadsonde::product
