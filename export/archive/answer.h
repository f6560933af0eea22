#pragma once
// What people and programs are told of an archive.
#include <string>
#include <vector>

#include "export/archive/archive.h"

namespace quadsonde::product {

/// One line per profile, for 80 columns, and a line that counts them.
std::string entries_text(const std::vector<ArchiveEntry>& entries);
/// Object of schema quadsonde.archive_list/1. `root` is put before files, so that they can be opened from here.
std::string entries_json(const std::vector<ArchiveEntry>& entries, const std::filesystem::path& root);
std::string entries_csv(const std::vector<ArchiveEntry>& entries, const std::filesystem::path& root);

/// "added 2025-06-15 06:00  NAME".
std::string added_text(const Added& added);
std::string added_json(const std::vector<Added>& added, const std::filesystem::path& root);

std::string verify_text(const VerifyReport& report);
std::string verify_json(const VerifyReport& report);
std::string rebuild_text(const RebuildReport& report);
std::string rebuild_json(const RebuildReport& report);

}  // namespace quadsonde::product
