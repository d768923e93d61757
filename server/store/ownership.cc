#include "server/store/ownership.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/error_hints.h"
#include "server/store/owner_tables.h"
#include "server/store/postgres_database.h"
#include "server/store/record_names.h"

namespace lipofill::server {
namespace {

constexpr char kReason[] = "OWNED_ELSEWHERE";
constexpr double kRetryDelayS = 1.0;
/// The file of a daemon is written right after its row, once a second.
constexpr int64_t kMostBeatsBehind = 3;

#define DAEMON_COLUMNS                                \
  "d.number, d.name, d.address, d.version, d.beats, " \
  "CAST(EXTRACT(EPOCH FROM now() - d.renewed) AS REAL), " LEASE_IS_LIVE("d")

/// @param first  the column where DAEMON_COLUMNS begin
DaemonRecord daemon_of(const Query& row, int first = 0) {
  DaemonRecord daemon;
  daemon.number = row.integer(first);
  daemon.name = row.text(first + 1);
  daemon.address = row.text(first + 2);
  daemon.version = row.text(first + 3);
  daemon.beats = row.integer(first + 4);
  daemon.age_s = row.real(first + 5);
  daemon.is_live = row.is_true(first + 6);
  return daemon;
}

}  // namespace

absl::Status owned_elsewhere(const std::string& simulation, const DaemonRecord& owner) {
  std::string message = absl::StrCat(simulation_name(simulation), " belongs to the daemon ", owner.name);
  if (!owner.is_live) {
    absl::StrAppend(&message, ", which has not been heard of for ", absl::StrFormat("%.1f", owner.age_s),
                    " s: another takes it over in a moment; try again");
  } else if (owner.address.empty()) {
    absl::StrAppend(&message, ", which is starting; try again");
  } else {
    absl::StrAppend(&message, " at ", owner.address, "; ask there");
  }
  return with_hints(absl::UnavailableError(message), {kReason, kRetryDelayS});
}

absl::Status no_lease() {
  return with_hints(absl::UnavailableError("this daemon has no lease at the moment, as it does not reach the database; "
                                           "what it owned may be another's by now"),
                    {"NO_LEASE", kRetryDelayS});
}

bool is_owned_elsewhere(const absl::Status& status) {
  const auto hints = hints_of(status);
  return hints && hints->reason == kReason;
}

absl::StatusOr<std::unique_ptr<Ownership>> Ownership::open(const std::string& place) {
  auto database = PostgresDatabase::open(place);
  if (!database.ok()) return database.status();
  return std::unique_ptr<Ownership>(new Ownership(*std::move(database)));
}

Ownership::Ownership(std::unique_ptr<PostgresDatabase> database) : database_(std::move(database)) {}

Ownership::~Ownership() = default;

absl::Status Ownership::execute(const std::string& sql) {
  return database_->execute(sql.c_str());
}

absl::Status Ownership::begin_start() {
  const std::lock_guard lock(mutex_);
  const absl::Status begun = execute(
      "SET lock_timeout = 60000; "
      "SELECT pg_advisory_lock(hashtext('lipofill start'), hashtext(current_schema()))");
  if (begun.ok() || !database_->is_connected()) return begun;
  return absl::UnavailableError(absl::StrCat("another daemon on ", database_->name(),
                                             " is starting and does not come to the end of it: ", begun.message()));
}

void Ownership::end_start() {
  const std::lock_guard lock(mutex_);
  execute("SELECT pg_advisory_unlock(hashtext('lipofill start'), hashtext(current_schema()))").IgnoreError();
}

absl::StatusOr<std::vector<DaemonRecord>> Ownership::join(const DataDirectory& directory, const std::string& version) {
  const std::lock_guard lock(mutex_);
  name_ = directory.name();
  version_ = version;
  auto others = check_others(directory);
  if (!others.ok()) return others.status();
  const LeaseClock::time_point asked = LeaseClock::now();
  // Nobody else has the lock on the name: who had the row is dead.
  Query insert(*database_,
               "INSERT INTO daemons (name, number, address, version, beats, renewed) "
               "VALUES (?, nextval('owner_epochs'), x'', ?, 0, now()) ON CONFLICT (name) DO UPDATE SET "
               "number = excluded.number, address = excluded.address, version = excluded.version, "
               "beats = excluded.beats, renewed = excluded.renewed RETURNING number");
  if (!insert.bind(name_, version_).next()) return insert.status();
  tenures_ = std::make_shared<Tenures>(insert.integer(0));
  member_ = directory.member(name_);
  if (absl::Status made = member_.make(tenures_->daemon()); !made.ok()) return made;
  tenures_->extend(begin_lease(asked));
  return others;
}

absl::StatusOr<std::vector<DaemonRecord>> Ownership::check_others(const DataDirectory& directory) {
  auto daemons = read_daemons();
  if (!daemons.ok()) return daemons.status();
  std::vector<DaemonRecord> others;
  for (const DaemonRecord& other : *daemons) {
    if (!other.is_live || other.name == name_) continue;
    const DataDirectory::Member::Beat beat = directory.member(other.name).read();
    if (beat.number != other.number || beat.beats < other.beats - kMostBeatsBehind) {
      return absl::FailedPreconditionError(absl::StrCat(
          "the daemon ", other.name, other.address.empty() ? "" : " at ", other.address, " serves ", database_->name(),
          " and has its files in another directory than ", directory.path().string(),
          ", or that is a copy: all daemons of a database share one directory; mount that one, or end ", other.name));
    }
    others.push_back(other);
  }
  return others;
}

LeaseClock::time_point Ownership::begin_lease(LeaseClock::time_point asked) {
  renewed_ = asked;
  return asked + kLease - kLeaseMargin;
}

absl::Status Ownership::announce(const std::string& address) {
  const std::lock_guard lock(mutex_);
  address_ = address;
  Query update(*database_, "UPDATE daemons SET address = ? WHERE number = ?");
  return update.bind(address_, tenures_->daemon()).run();
}

absl::StatusOr<LeaseClock::time_point> Ownership::renew() {
  const std::lock_guard lock(mutex_);
  if (has_left_) return no_lease();
  const int64_t number = member_.read().number;
  if (number == 0) return directory_gone();
  if (number != tenures_->daemon()) return same_name();
  const LeaseClock::time_point asked = LeaseClock::now();
  // Nobody may keep this connection waiting for longer than a lease has left.
  absl::Status done = execute("SET lock_timeout = 1000");
  // A row that somebody took out comes again, unless its name is another's by now.
  Query renewal(*database_,
                "INSERT INTO daemons AS d (name, number, address, version, beats, renewed) "
                "VALUES (?1, ?2, ?3, ?4, ?5, now()) ON CONFLICT (name) DO UPDATE SET beats = excluded.beats, "
                "address = excluded.address, renewed = excluded.renewed WHERE d.number = ?2 RETURNING number");
  if (!done.ok()) return done;
  renewal.bind(name_, tenures_->daemon(), address_, version_, beats_ + 1);
  const bool is_renewed = renewal.next();
  if (!renewal.status().ok()) return renewal.status();
  if (!is_renewed) return same_name();
  ++beats_;
  if (absl::Status told = member_.write({tenures_->daemon(), beats_}); !told.ok()) return told;
  return begin_lease(asked);
}

absl::Status Ownership::directory_gone() const {
  return absl::FailedPreconditionError(absl::StrCat("the directory that this daemon shares has gone: there is no ",
                                                    member_.file.string(), "; mount it again"));
}

absl::Status Ownership::same_name() const {
  return absl::FailedPreconditionError(absl::StrCat("another daemon serves ", database_->name(), " under the name ",
                                                    name_, "; end one of them, and give each a name of its own"));
}

void Ownership::leave() {
  const std::lock_guard lock(mutex_);
  if (tenures_ == nullptr) return;
  has_left_ = true;
  tenures_->extend({});
  execute(absl::StrCat("DELETE FROM simulation_owners WHERE daemon = ", tenures_->daemon(),
                       "; DELETE FROM daemons WHERE number = ", tenures_->daemon()))
      .IgnoreError();  // the lease ends in a while
}

absl::Status Ownership::take(const std::string& simulation) {
  const std::lock_guard lock(mutex_);
  if (!tenures_->is_held()) return no_lease();
  const auto before = read_owner(simulation);
  if (!before.ok()) return before.status();
  Query insert(
      *database_,
      "INSERT INTO simulation_owners AS o (simulation, daemon, epoch) VALUES (?1, ?2, nextval('owner_epochs')) "
      "ON CONFLICT (simulation) DO UPDATE SET daemon = excluded.daemon, epoch = excluded.epoch "
      "WHERE o.daemon = ?2 OR o.daemon NOT IN (SELECT d.number FROM daemons d WHERE " LEASE_IS_LIVE(
          "d") ") RETURNING epoch");
  const bool is_taken = insert.bind(simulation, tenures_->daemon()).next();
  if (!insert.status().ok()) return insert.status();
  if (is_taken) {
    tenures_->note(simulation, insert.unsigned_integer(0));
    if (before->has_value() && (*before)->number != tenures_->daemon()) ++n_takeovers_;
    return absl::OkStatus();
  }
  const auto owner = read_owner(simulation);
  if (!owner.ok()) return owner.status();
  return owned_elsewhere(simulation, owner->value_or(DaemonRecord{}));
}

void Ownership::give_back(const std::string& simulation, uint64_t epoch) {
  const std::lock_guard lock(mutex_);
  Query remove(*database_, "DELETE FROM simulation_owners WHERE simulation = ? AND daemon = ? AND epoch = ?");
  remove.bind(simulation, tenures_->daemon(), epoch).run().IgnoreError();  // list_own() tells of it
  tenures_->forget(simulation, epoch);
}

absl::StatusOr<std::optional<DaemonRecord>> Ownership::owner_of(const std::string& simulation) {
  const std::lock_guard lock(mutex_);
  return read_owner(simulation);
}

// An owner that is not among the daemons is one that was, or was written by hand.
absl::StatusOr<std::optional<DaemonRecord>> Ownership::read_owner(const std::string& simulation) {
  Query query(*database_, "SELECT " DAEMON_COLUMNS
                          ", o.daemon FROM simulation_owners o LEFT JOIN daemons d ON d.number = o.daemon "
                          "WHERE o.simulation = ?");
  if (query.bind(simulation).next()) {
    DaemonRecord owner = daemon_of(query);
    if (owner.number == 0) {
      owner.number = query.integer(7);
      owner.name = absl::StrCat("number ", owner.number);
    }
    return owner;
  }
  if (!query.status().ok()) return query.status();
  return std::nullopt;
}

absl::StatusOr<std::map<std::string, uint64_t>> Ownership::list_own() {
  const std::lock_guard lock(mutex_);
  Query query(*database_, "SELECT simulation, epoch FROM simulation_owners WHERE daemon = ?");
  query.bind(tenures_->daemon());
  std::map<std::string, uint64_t> own;
  while (query.next()) own[query.text(0)] = query.unsigned_integer(1);
  if (!query.status().ok()) return query.status();
  return own;
}

absl::StatusOr<std::vector<Orphan>> Ownership::list_orphans() {
  const std::lock_guard lock(mutex_);
  Query query(*database_,
              "SELECT s.id, d.number IS NOT NULL, " DAEMON_COLUMNS
              " FROM simulations s LEFT JOIN simulation_owners o ON o.simulation = s.id "
              "LEFT JOIN daemons d ON d.number = o.daemon "
              "WHERE s.state < 4 AND " LEASE_IS_LIVE("d") " IS NOT TRUE "
              "AND NOT (s.state IN (1, 3) AND s.summary <> x'') ORDER BY s.id");
  std::vector<Orphan> orphans;
  while (query.next()) {
    Orphan& orphan = orphans.emplace_back();
    orphan.simulation = query.text(0);
    if (!query.is_true(1)) continue;
    const DaemonRecord daemon = daemon_of(query, 2);
    orphan.daemon = daemon.name;
    orphan.age_s = daemon.age_s;
  }
  if (!query.status().ok()) return query.status();
  return orphans;
}

absl::StatusOr<std::vector<DaemonRecord>> Ownership::list_daemons() {
  const std::lock_guard lock(mutex_);
  return read_daemons();
}

absl::StatusOr<std::vector<DaemonRecord>> Ownership::read_daemons() {
  Query query(*database_, "SELECT " DAEMON_COLUMNS " FROM daemons d ORDER BY d.name");
  std::vector<DaemonRecord> daemons;
  while (query.next()) daemons.push_back(daemon_of(query));
  if (!query.status().ok()) return query.status();
  return daemons;
}

absl::Status take_ownership(const Store& store, const std::string& simulation) {
  Ownership* const ownership = ownership_of(store);
  return ownership == nullptr ? absl::OkStatus() : ownership->take(simulation);
}

TakenForNow::TakenForNow(const Store& store, std::string simulation)
    : ownership_(ownership_of(store)), simulation_(std::move(simulation)) {
  // It keeps one that it owned before.
  if (ownership_ != nullptr && ownership_->tenures()->epoch_of(simulation_)) ownership_ = nullptr;
}

TakenForNow::~TakenForNow() {
  if (ownership_ == nullptr) return;
  if (const auto epoch = ownership_->tenures()->epoch_of(simulation_)) ownership_->give_back(simulation_, *epoch);
}

std::chrono::duration<double> Ownership::lease_age() const {
  return LeaseClock::now() - renewed_.load();
}

}  // namespace lipofill::server
