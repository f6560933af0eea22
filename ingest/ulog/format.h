#pragma once
// Inside of the container: what the definition section says.
#include "ingest/ulog/container.h"

namespace quadsonde::ingest::ulog {

/// "name:type field;type[n] field;..."
std::optional<Format> parse_format(std::string_view text);
/// "float[3] xyz"
std::optional<Field> parse_typed_name(std::string_view text);
/// Bytes of a format with its trailing padding; empty if it cannot be told.
std::optional<std::uint64_t> format_size(const Formats& formats, std::string_view name);

}  // namespace quadsonde::ingest::ulog
