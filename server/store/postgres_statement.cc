#include "server/store/postgres_statement.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "absl/strings/numbers.h"
#include "pqxx/binarystring"
#include "pqxx/field"
#include "pqxx/row"

namespace lipofill::server {
namespace {

// Types of PostgreSQL, as its catalogue numbers them.
constexpr pqxx::oid kBool = 16;
constexpr pqxx::oid kBytea = 17;

/// Eight bytes, the most significant one first.
std::string to_network_order(uint64_t bits) {
  std::string bytes(sizeof bits, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(bits >> (56 - 8 * i));
  return bytes;
}

}  // namespace

void PostgresStatement::bind(int index, const std::string& bytes) {
  parameters_.resize(std::max(parameters_.size(), static_cast<size_t>(index)));
  parameters_[static_cast<size_t>(index) - 1] = bytes;
}

void PostgresStatement::bind(int index, int64_t value) {
  bind(index, to_network_order(static_cast<uint64_t>(value)));
}

void PostgresStatement::bind(int index, double value) {
  bind(index, to_network_order(std::bit_cast<uint64_t>(value)));
}

bool PostgresStatement::next() {
  if (!status_.ok()) return false;
  if (!rows_.has_value()) {
    auto rows = database_.execute_prepared(sql_, parameters_);
    if (!rows.ok()) {
      status_ = rows.status();
      return false;
    }
    rows_ = *std::move(rows);
  }
  const int n_rows = static_cast<int>(rows_->size());
  if (row_ < n_rows) ++row_;
  return row_ < n_rows;
}

pqxx::field PostgresStatement::field(int column) const {
  return rows_->at(static_cast<pqxx::result::size_type>(row_)).at(static_cast<pqxx::row::size_type>(column));
}

int64_t PostgresStatement::integer(int column) const {
  const pqxx::field value = field(column);
  if (value.type() == kBool) return value.c_str()[0] == 't' ? 1 : 0;
  int64_t number = 0;
  return absl::SimpleAtoi(value.c_str(), &number) ? number : 0;
}

double PostgresStatement::real(int column) const {
  double number = 0.0;
  return absl::SimpleAtod(field(column).c_str(), &number) ? number : 0.0;
}

std::string PostgresStatement::text(int column) const {
  const pqxx::field value = field(column);
  return value.type() == kBytea ? pqxx::binarystring(value).str() : std::string(value.c_str(), value.size());
}

}  // namespace lipofill::server
