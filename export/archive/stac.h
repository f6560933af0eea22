#pragma once
// The archive as a STAC 1.0 catalogue: catalog.json -> collection.json -> year -> month -> station -> items, all links
// relative, so that it may be moved, served or put on a memory stick as it is.
// Source: STAC specification 1.0.0 (item, catalog, collection); extensions version 1.2.0, file 2.1.0, processing 1.1.0.
#include <string>
#include <vector>

#include "export/archive/entry.h"

namespace quadsonde::product {

/// Other versions of an item's flight, as names; empty where there is none.
struct Versions {
  std::string predecessor, successor, latest;
  std::string folder_of_predecessor, folder_of_successor, folder_of_latest;
};

struct ArchiveExtent {
  bool any = false;
  double west = 0, south = 0, east = 0, north = 0, start_s = 0, end_s = 0;
};

std::string stac_item(const ArchiveEntry& entry, const Versions& versions);
/// The root: names the collection.
std::string stac_root();
/// @param years  folders below profiles/
std::string stac_collection(const ArchiveExtent& extent, const std::vector<std::string>& years);
/// Of profiles/2025 or profiles/2025/06: @param children folders in it
std::string stac_branch(const std::string& folder, const std::vector<std::string>& children);
/// Of profiles/2025/06/STATION: @param items  names of entries
std::string stac_leaf(const std::string& folder, const std::vector<std::string>& items);

}  // namespace quadsonde::product
