#include "core/forecast/part_bytes.h"

#include <cstdint>
#include <cstring>

#include "core/base/hash.h"

namespace lipofill::forecast {
namespace {

using simulation::MemberResult;
using simulation::MemberShape;

constexpr size_t kHash = 64;
constexpr char kKind[] = "lipofill forecast part 1";

std::string hash_of(std::string_view body) {
  Hasher hasher;
  hasher.add(kKind);
  hasher.add(body);
  return hasher.hex_digest();
}

void put(const void* data, size_t size, std::string& bytes) {
  bytes.append(static_cast<const char*>(data), size);
}

template <typename Values>
void put_values(const Values& values, std::string& bytes) {
  const auto n = static_cast<uint64_t>(values.size());
  put(&n, sizeof n, bytes);
  put(values.data(), n * sizeof(values.data()[0]), bytes);
}

/// Reads in the order in which was written. What a hash holds together is whole.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}
  template <typename Value>
  Value value() {
    Value value{};
    std::memcpy(&value, bytes_.data(), sizeof value);
    bytes_.remove_prefix(sizeof value);
    return value;
  }
  template <typename Values>
  void values(Values& to) {
    std::memcpy(to.data(), bytes_.data(), static_cast<size_t>(to.size()) * sizeof(to.data()[0]));
    bytes_.remove_prefix(static_cast<size_t>(to.size()) * sizeof(to.data()[0]));
  }

 private:
  std::string_view bytes_;
};

void put_shape(const MemberShape& shape, std::string& bytes) {
  put_values(shape.skin, bytes);
  put(&shape.max_lift, sizeof shape.max_lift, bytes);
  put(&shape.skin_volume, sizeof shape.skin_volume, bytes);
  put_values(shape.pressure, bytes);
  put_values(shape.volume, bytes);
}

MemberShape read_shape(Reader& reader) {
  MemberShape shape;
  shape.skin.resize(3, static_cast<Eigen::Index>(reader.value<uint64_t>() / 3));
  reader.values(shape.skin);
  shape.max_lift = reader.value<double>();
  shape.skin_volume = reader.value<double>();
  shape.pressure.resize(static_cast<Eigen::Index>(reader.value<uint64_t>()));
  reader.values(shape.pressure);
  shape.volume.resize(static_cast<Eigen::Index>(reader.value<uint64_t>()));
  reader.values(shape.volume);
  return shape;
}

}  // namespace

std::string write_part(const std::vector<MemberResult>& members) {
  std::string body;
  const auto n = static_cast<uint64_t>(members.size());
  put(&n, sizeof n, body);
  for (const MemberResult& member : members) {
    put_values(member.failure, body);
    const auto n_shapes = static_cast<uint64_t>(member.shapes.size());
    put(&n_shapes, sizeof n_shapes, body);
    for (const MemberShape& shape : member.shapes) put_shape(shape, body);
  }
  return hash_of(body) + body;
}

std::optional<std::vector<MemberResult>> read_part(std::string_view bytes, size_t members) {
  if (bytes.size() < kHash || hash_of(bytes.substr(kHash)) != bytes.substr(0, kHash)) return {};
  Reader reader(bytes.substr(kHash));
  if (reader.value<uint64_t>() != members) return {};
  std::vector<MemberResult> results(members);
  for (MemberResult& member : results) {
    member.failure.resize(reader.value<uint64_t>());
    reader.values(member.failure);
    const auto n_shapes = reader.value<uint64_t>();
    for (uint64_t k = 0; k < n_shapes; ++k) member.shapes.push_back(read_shape(reader));
  }
  return results;
}

}  // namespace lipofill::forecast
