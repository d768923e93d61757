#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "core/base/field_violations.h"
#include "core/geometry/face_geometry.h"
#include "lipofill/v1/geometry.pb.h"

namespace lipofill::server {

/// Reads a message into SI values of the core, noting what is missing under the path of the field.
/// Ranges are the core's business; numbers that are not finite and unknown enumerators have been
/// refused before (message_check.h).
/// Checked by tests/unit/server/wire/conversion_test.cc.
class FieldReader {
 public:
  FieldReader(std::string path, FieldViolations& violations) : path_(std::move(path)), violations_(violations) {}

  std::string path(const std::string& field) const { return path_.empty() ? field : path_ + "." + field; }
  FieldReader below(const std::string& field) const { return FieldReader(path(field), violations_); }
  FieldReader below(const std::string& field, int index) const {
    return FieldReader(path(field) + "[" + std::to_string(index) + "]", violations_);
  }
  void missing(const std::string& field) const { violations_.add(path(field), "is missing"); }
  void wrong(const std::string& field, const std::string& description) const {
    violations_.add(path(field), description);
  }
  const std::string& here() const { return path_; }
  void wrong_here(const std::string& description) const { violations_.add(path_, description); }
  void missing_here() const { violations_.add(path_, "is missing"); }

  /// The value times `factor`, or 0 with a violation.
  double required(bool has, double value, double factor, const std::string& field) const {
    if (!has) missing(field);
    return has ? value * factor : 0.0;
  }
  int required_count(bool has, uint32_t value, const std::string& field) const;
  /// The value, of which 0 is a violation, or 0 where there is none: the core chooses.
  int count_or_choice(bool has, uint32_t value, const std::string& field) const;

 private:
  std::string path_;
  FieldViolations& violations_;
};

Eigen::Vector3d read_vector(const v1::Vector3& message, double factor, const FieldReader& reader);
geometry::ScalarField read_samples(const v1::FieldSamples& message, double factor, const FieldReader& reader);
geometry::ScalarField read_scalar_field(const v1::ScalarField& message, double factor, const FieldReader& reader);
geometry::SkinPoint read_skin_point(const v1::SkinPoint& message, const FieldReader& reader);

}  // namespace lipofill::server
