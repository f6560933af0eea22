#include "export/csv/section_tables.h"

#include "export/csv/json.h"
#include "export/csv/numbers.h"
#include "export/csv/rows.h"

namespace quadsonde::product {
namespace {

void append(std::string& text, const Row& row, bool names) {
  for (const auto& field : row) {
    if (&field != &row.front()) text += ',';
    text += names ? std::string(field.name) : field.text;
  }
}

}  // namespace

std::string section_csv(const profiles::Section& section) {
  std::string text;
  append(text, profile_row({}, profiles::LegName::all), true);
  text += ",section_column,section_from_utc,section_to_utc\n";
  for (std::size_t i = 0; i < section.columns.size(); ++i) {
    const auto& column = section.columns[i];
    const auto tail = "," + std::to_string(i + 1) + "," + utc_text(column.from) + "," + utc_text(column.to) + "\n";
    for (const auto& bin : column.leg.bins) {
      append(text, profile_row(bin, column.leg.name), false);
      text += tail;
    }
  }
  return text;
}

std::string section_json(const profiles::Section& section, const ProductSource& source) {
  Json object = json_head("quadsonde.section/1", source);
  object["datum"] = std::string(profiles::name(section.datum));
  object["bin_m"] = section.bin_m;
  Json columns = Json::array(), rows = Json::array();
  for (std::size_t i = 0; i < section.columns.size(); ++i) {
    const auto& column = section.columns[i];
    columns.push_back({{"section_column", i + 1},
                       {"flight", column.flight},
                       {"leg", std::string(profiles::name(column.leg.name))},
                       {"from_utc", utc_text(column.from)},
                       {"to_utc", utc_text(column.to)}});
    for (const auto& bin : column.leg.bins) {
      auto row = json_row(bin, column.leg.name);
      row["section_column"] = i + 1;
      rows.push_back(std::move(row));
    }
  }
  object["columns"] = std::move(columns);
  object["rows"] = std::move(rows);
  return json_text(object);
}

}  // namespace quadsonde::product
