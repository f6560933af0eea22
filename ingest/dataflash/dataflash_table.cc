#include "ingest/dataflash/dataflash_table.h"

namespace quadsonde::ingest::dataflash {
namespace {

const DataflashField* find_any(const DataflashLayout& layout, std::string_view alternatives) {
  while (!alternatives.empty()) {
    const auto bar = alternatives.find('|');
    if (const auto* field = layout.find(alternatives.substr(0, bar))) return field;
    if (bar == std::string_view::npos) break;
    alternatives.remove_prefix(bar + 1);
  }
  return nullptr;
}

bool is_integer(const DataflashField& field) {
  return std::string_view("bBhHiIqQM").find(field.code) != std::string_view::npos;
}

/// TimeUS since 2015. Before that TimeMS, but for GPS, whose TimeMS is of the GPS week and whose boot time is T.
void bind_time(const DataflashLayout& layout, Binding& binding) {
  const bool old_gps = binding.row == Row::gps && layout.find("TimeUS") == nullptr;
  binding.time = old_gps ? layout.find("T") : find_any(layout, "TimeUS|TimeMS");
  if (binding.time != nullptr && !is_integer(*binding.time)) binding.time = nullptr;
  if (binding.time != nullptr) binding.time_unit_ns = binding.time->label == "TimeUS" ? 1e3 : 1e6;
}

}  // namespace

Binding bind(const DataflashLayout& layout) {
  Binding binding;
  binding.layout_generation = layout.generation;
  for (const auto& spec : rows) {
    if (spec.message != layout.name || layout.fields.empty()) continue;
    binding.row = spec.row;
    binding.ekf = spec.generation;
    binding.fixed_instance = spec.instance;
    bind_time(layout, binding);
    for (std::size_t i = 0; i < most_values; ++i) binding.fields[i] = find_any(layout, spec.labels[i]);
    // The units say which field numbers the instances ('#'); without units its usual names do.
    for (const auto& field : layout.fields)
      if (field.unit == '#' && is_integer(field)) binding.instance = &field;
    if (binding.instance == nullptr) binding.instance = find_any(layout, "I|C|Instance|Inst|Id");
    if (binding.instance != nullptr && !is_integer(*binding.instance)) binding.instance = nullptr;
    break;
  }
  return binding;
}

}  // namespace quadsonde::ingest::dataflash
