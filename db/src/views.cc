#include "touchdown/db/views.h"

#include <fmt/format.h>

#include "schema_parts.h"
#include "statement.h"

namespace touchdown::db {

void ForEachRow(const Store& store, const View& view, std::string_view campaign,
                const std::function<void(std::span<const Cell>)>& visit) {
  Connection& connection = store.connection();
  Transaction snapshot(connection, Transaction::Kind::kRead);
  // The program's own text of it: the one in the file could be anybody's.
  Statement row(connection,
                fmt::format("SELECT * FROM ({}) WHERE ?1 = '' OR campaign = ?1",
                            ViewQuery(view.name)));
  row.Add(campaign);
  std::vector<Cell> cells(view.columns.size());
  while (row.Step()) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (row.NextIsNull()) {
        row.Skip(1);
        cells[i] = std::monostate();
        continue;
      }
      switch (view.columns[i].type) {
        case ColumnType::kText:
          cells[i] = row.TakeText();
          break;
        case ColumnType::kInteger:
          cells[i] = row.TakeInteger();
          break;
        case ColumnType::kReal:
          cells[i] = row.TakeReal();
          break;
      }
    }
    visit(cells);
  }
}

}  // namespace touchdown::db
