#include "server/store/owner_fence.h"

#include "absl/strings/str_cat.h"
#include "server/store/ownership.h"
#include "server/store/record_names.h"
#include "server/store/sql_store.h"

namespace lipofill::server {

Ownership* ownership_of(const Store& store) {
  const auto* shared = dynamic_cast<const SqlStore*>(&store);
  return shared != nullptr ? shared->ownership() : nullptr;
}

void OwnerFence::raise(Ownership& ownership) {
  ownership_ = &ownership;
  tenures_ = ownership.tenures();
}

// The row of the owner is locked until the end of what is written: whoever takes the simulation
// over waits for that, and then finds it.
absl::Status OwnerFence::check(const std::string& simulation, Unowned unowned) {
  if (tenures_ == nullptr) return absl::OkStatus();
  Query query(database_, "SELECT daemon, epoch FROM simulation_owners WHERE simulation = ? FOR SHARE");
  if (query.bind(simulation).next()) {
    const bool is_own =
        query.integer(0) == tenures_->daemon() && tenures_->epoch_of(simulation) == query.unsigned_integer(1);
    return is_own ? absl::OkStatus() : refuse(simulation, query.integer(0));
  }
  if (!query.status().ok() || unowned == Unowned::kMayBeWritten) return query.status();
  Query record(database_, "SELECT 1 FROM simulations WHERE id = ?");
  if (record.bind(simulation).next()) return refuse(simulation, 0);
  if (!record.status().ok()) return record.status();
  return absl::NotFoundError(absl::StrCat("there is no ", simulation_name(simulation)));
}

absl::Status OwnerFence::refuse(const std::string& simulation, int64_t daemon) {
  Query query(database_, "SELECT name, address FROM daemons WHERE number = ?");
  DaemonRecord owner;
  owner.is_live = query.bind(daemon).next();
  owner.name = owner.is_live ? query.text(0) : "that had it last";
  if (owner.is_live) owner.address = query.text(1);
  return owned_elsewhere(simulation, owner);
}

absl::Status OwnerFence::write_owner(const std::string& simulation) {
  if (tenures_ == nullptr) return absl::OkStatus();
  Query insert(database_,
               "INSERT INTO simulation_owners (simulation, daemon, epoch) VALUES (?, ?, nextval('owner_epochs')) "
               "RETURNING epoch");
  if (!insert.bind(simulation, tenures_->daemon()).next()) return insert.status();
  tenures_->note(simulation, insert.unsigned_integer(0));
  return absl::OkStatus();
}

absl::Status OwnerFence::erase_owner(const std::string& simulation) {
  if (tenures_ == nullptr) return absl::OkStatus();
  Query remove(database_, "DELETE FROM simulation_owners WHERE simulation = ?");
  return remove.bind(simulation).run();
}

void OwnerFence::forget(const std::string& simulation) {
  if (tenures_ != nullptr) tenures_->forget(simulation);
}

}  // namespace lipofill::server
