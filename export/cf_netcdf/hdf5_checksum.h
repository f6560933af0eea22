#pragma once
#include <cstdint>
#include <string_view>

namespace quadsonde::product {

/// The checksum that HDF5 keeps of its metadata. Source: R. Jenkins, lookup3.c, hashlittle() with initval 0 (2006);
/// HDF5 File Format Specification 3.0, "Disk Format: Level 0A", superblock checksum.
std::uint32_t hdf5_checksum(std::string_view bytes);

}  // namespace quadsonde::product
