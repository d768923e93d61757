#include "client/cpp/message_figures.h"

#include <google/protobuf/descriptor.h>

#include <charconv>

#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace lipofill::client {
namespace {

using google::protobuf::Descriptor;
using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using nlohmann::ordered_json;

constexpr char kOfProbes[] = "probe_";

/// The value of a field, or of element `index` of a repeated one.
ordered_json value_of(const Message& message, const FieldDescriptor& field, int index) {
  const google::protobuf::Reflection& access = *message.GetReflection();
  const bool many = field.is_repeated();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_BOOL:
      return many ? access.GetRepeatedBool(message, &field, index) : access.GetBool(message, &field);
    case FieldDescriptor::CPPTYPE_INT32:
      return many ? access.GetRepeatedInt32(message, &field, index) : access.GetInt32(message, &field);
    case FieldDescriptor::CPPTYPE_INT64:
      return many ? access.GetRepeatedInt64(message, &field, index) : access.GetInt64(message, &field);
    case FieldDescriptor::CPPTYPE_UINT32:
      return many ? access.GetRepeatedUInt32(message, &field, index) : access.GetUInt32(message, &field);
    case FieldDescriptor::CPPTYPE_UINT64:
      return many ? access.GetRepeatedUInt64(message, &field, index) : access.GetUInt64(message, &field);
    case FieldDescriptor::CPPTYPE_FLOAT:
      return many ? access.GetRepeatedFloat(message, &field, index) : access.GetFloat(message, &field);
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return many ? access.GetRepeatedDouble(message, &field, index) : access.GetDouble(message, &field);
    case FieldDescriptor::CPPTYPE_STRING:
      return many ? access.GetRepeatedString(message, &field, index) : access.GetString(message, &field);
    case FieldDescriptor::CPPTYPE_ENUM:
      return (many ? access.GetRepeatedEnum(message, &field, index) : access.GetEnum(message, &field))->name();
    case FieldDescriptor::CPPTYPE_MESSAGE:
      return figures_of(many ? access.GetRepeatedMessage(message, &field, index) : access.GetMessage(message, &field));
  }
  return nullptr;
}

void add_columns_of_probes(const Descriptor& type, const std::vector<const FieldDescriptor*>& path,
                           const v1::SimulationSpec& spec, std::vector<SeriesColumn>& columns) {
  for (int probe = 0; probe < spec.probes_size(); ++probe) {
    for (int i = 0; i < type.field_count(); ++i) {
      if (!type.field(i)->is_repeated()) continue;
      const std::string figure(absl::StripPrefix(type.field(i)->name(), kOfProbes));
      SeriesColumn& column = columns.emplace_back();
      column.name = absl::StrCat(kOfProbes, spec.probes(probe).name(), "_", figure);
      column.path = path;
      column.path.push_back(type.field(i));
      column.probe = probe;
    }
  }
}

void add_columns(const Descriptor& type, const std::vector<const FieldDescriptor*>& above,
                 const v1::SimulationSpec& spec, std::vector<SeriesColumn>& columns) {
  bool has_probes = false;
  for (int i = 0; i < type.field_count(); ++i) {
    const FieldDescriptor& field = *type.field(i);
    std::vector<const FieldDescriptor*> path = above;
    path.push_back(&field);
    if (field.is_repeated()) {
      if (!has_probes) add_columns_of_probes(type, above, spec, columns);
      has_probes = true;
    } else if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      add_columns(*field.message_type(), path, spec, columns);
    } else {
      columns.push_back({field.name(), path, -1});
    }
  }
}

std::string shortest_text(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc() ? std::string(text, end) : "nan";
}

}  // namespace

ordered_json figures_of(const Message& message) {
  const google::protobuf::Reflection& access = *message.GetReflection();
  ordered_json figures = ordered_json::object();
  for (int i = 0; i < message.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *message.GetDescriptor()->field(i);
    ordered_json& figure = figures[field.name()];
    if (field.is_repeated()) {
      figure = ordered_json::array();
      for (int k = 0; k < access.FieldSize(message, &field); ++k) figure.push_back(value_of(message, field, k));
    } else if (!field.has_presence() || access.HasField(message, &field)) {
      figure = value_of(message, field, 0);
    }
  }
  return figures;
}

std::vector<SeriesColumn> columns_of_series(const v1::SimulationSpec& spec) {
  std::vector<SeriesColumn> columns;
  add_columns(*v1::SeriesRow::descriptor(), {}, spec, columns);
  return columns;
}

std::string value_text(const v1::SeriesRow& row, const SeriesColumn& column) {
  const Message* holder = &row;
  for (size_t k = 0; k + 1 < column.path.size(); ++k) {
    holder = &holder->GetReflection()->GetMessage(*holder, column.path[k]);
  }
  const FieldDescriptor& field = *column.path.back();
  if (column.probe >= 0 && column.probe >= holder->GetReflection()->FieldSize(*holder, &field)) return "";
  const ordered_json value = value_of(*holder, field, column.probe);
  return value.is_number_float() ? shortest_text(value.get<double>()) : value.dump();
}

}  // namespace lipofill::client
