// The store as people and other programs read it: views in degrees and
// millimetres, with a dictionary of their columns. They are part of the file,
// so that any program that reads SQLite has them (docs/reading-the-store.md);
// their names and columns are kept, columns may be added.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "touchdown/db/store.h"

namespace touchdown::db {

enum class ColumnType { kText, kInteger, kReal };
std::string_view Name(ColumnType type);  // "text", "integer", "real"

struct ViewColumn {
  std::string name;
  ColumnType type = ColumnType::kText;
  std::string unit;  // "deg", "mm" ...; empty: a text, a word or a count
  std::string meaning;
};

struct View {
  std::string name;     // "v_trials" ...
  std::string one_row;  // what one row is
  std::vector<ViewColumn> columns;
};

// v_campaigns, v_trials, v_contacts, v_tracks, v_revisions. In the file there
// is v_columns besides: the same dictionary, one row a column.
const std::vector<View>& Views();

// "deg", "m/s" ... of a name at the edge (core/edge_unit.h); empty: none.
std::string FindUnit(std::string_view edge_name);

using Cell = std::variant<std::monostate, std::int64_t, double, std::string>;

// Every row of a view, from one snapshot; of one campaign where it is named.
void ForEachRow(const Store& store, const View& view, std::string_view campaign,
                const std::function<void(std::span<const Cell>)>& visit);

}  // namespace touchdown::db
