#pragma once

namespace lipofill::server {

// Who owns which simulation, in PostgreSQL alone. These tables keep nothing of a user, so they have
// no sums and no version: they are made where they are missing.

/// A daemon has one lease for all that it owns, renewed by its row. Numbers of daemons and epochs
/// are of one sequence, so that none ever comes again, also where a row was written by hand.
inline constexpr char kOwnerTables[] = R"(
CREATE SEQUENCE owner_epochs;
CREATE TABLE daemons (
  name BYTEA PRIMARY KEY, number BIGINT NOT NULL UNIQUE, address BYTEA NOT NULL, version BYTEA NOT NULL,
  beats BIGINT NOT NULL DEFAULT 0, renewed TIMESTAMPTZ NOT NULL) WITH (fillfactor = 50);
CREATE TABLE simulation_owners (
  simulation BYTEA PRIMARY KEY REFERENCES simulations(id) ON DELETE CASCADE, daemon BIGINT NOT NULL,
  epoch BIGINT NOT NULL);
CREATE INDEX simulation_owners_by_daemon ON simulation_owners(daemon);
CREATE INDEX simulations_unended ON simulations(id) WHERE state < 4;
)";

}  // namespace lipofill::server

/// A condition: the lease in a row of daemons has not ended, by the clock of the database. One that
/// was renewed in the future was written before that clock was set back, or by hand: the daemon
/// that lives renews it within a second.
#define LEASE_IS_LIVE(daemons)                                       \
  "(" daemons ".renewed > now() - interval '4 seconds' AND " daemons \
  ".renewed < now() "                                                \
  "+ interval '4 seconds')"
