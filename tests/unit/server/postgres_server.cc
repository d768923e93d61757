#include "tests/unit/server/postgres_server.h"

#include <gtest/gtest.h>
#include <libpq-fe.h>
#include <pwd.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

namespace lipofill::testing {
namespace {

constexpr char kPrograms[] = "/usr/lib/postgresql/15/bin";
constexpr char kUser[] = "lipofill";

/// The user that PostgreSQL runs as where this one is root; null where it is not.
const passwd* other_user() {
  return ::geteuid() == 0 ? ::getpwnam("postgres") : nullptr;
}

/// In a child: becomes that user, ends with the test, and becomes the program.
[[noreturn]] void become(const std::string& command, const std::string& log) {
  ::prctl(PR_SET_PDEATHSIG, SIGQUIT);
  if (const passwd* user = other_user(); user != nullptr) {
    if (::setgid(user->pw_gid) != 0 || ::setuid(user->pw_uid) != 0) ::_exit(126);
    ::prctl(PR_SET_PDEATHSIG, SIGQUIT);  // a change of the user takes it back
  }
  const std::string line = "exec " + std::string(kPrograms) + "/" + command + " >>" + log + " 2>&1";
  ::execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
  ::_exit(127);
}

std::string text_of(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

PostgresServer::PostgresServer() {
  std::string pattern = (std::filesystem::temp_directory_path() / "lipofill_pg_XXXXXX").string();
  directory_ = ::mkdtemp(pattern.data());
  if (const passwd* user = other_user(); user != nullptr) {
    EXPECT_EQ(::chown(directory_.c_str(), user->pw_uid, user->pw_gid), 0);
  }
  run_to_end("initdb -D " + directory_ + "/data -U " + kUser + " -A trust -E UTF8 --locale=C -N -k");
  start();
}

PostgresServer::~PostgresServer() {
  end(SIGQUIT);
  std::error_code ignored;
  std::filesystem::remove_all(directory_, ignored);
}

void PostgresServer::run_to_end(const std::string& command) const {
  const pid_t child = ::fork();
  if (child == 0) become(command, directory_ + "/log");
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0) << command << ":\n" << text_of(directory_ + "/log");
}

void PostgresServer::start() {
  const std::string command = "postgres -D " + directory_ + "/data -k " + directory_ +
                              " -c listen_addresses= -c fsync=off -c log_statement=none -c max_connections=50";
  process_ = ::fork();
  if (process_ == 0) become(command, directory_ + "/log");
  const std::string settings = "host=" + directory_ + " user=" + kUser + " dbname=postgres connect_timeout=2";
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (::PQping(settings.c_str()) != PQPING_OK && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_EQ(::PQping(settings.c_str()), PQPING_OK) << "PostgreSQL does not serve:\n" << text_of(directory_ + "/log");
}

void PostgresServer::end(int signal) {
  if (process_ <= 0) return;
  ::kill(process_, signal);
  ::waitpid(process_, nullptr, 0);
  process_ = -1;
}

void PostgresServer::stop() {
  end(SIGINT);
}

void PostgresServer::crash() {
  end(SIGQUIT);
}

std::string PostgresServer::make_place() {
  const std::string schema = "s" + std::to_string(++n_places_);
  const std::string place =
      "postgresql://" + std::string(kUser) + "@/postgres?host=" + directory_ + "&options=-csearch_path%3D" + schema;
  execute(place, "CREATE SCHEMA " + schema);
  return place;
}

std::string PostgresServer::through(const std::string& place, const std::string& directory) {
  const size_t begin = place.find("host=") + 5;
  return place.substr(0, begin) + directory + place.substr(place.find('&', begin));
}

void PostgresServer::execute(const std::string& place, const std::string& sql) {
  PGconn* connection = ::PQconnectdb(place.c_str());
  PGresult* result = ::PQexec(connection, sql.c_str());
  const ExecStatusType status = ::PQresultStatus(result);
  EXPECT_TRUE(status == PGRES_COMMAND_OK || status == PGRES_TUPLES_OK) << sql << ": " << ::PQerrorMessage(connection);
  ::PQclear(result);
  ::PQfinish(connection);
}

PostgresServer& PostgresServer::of_program() {
  static PostgresServer server;
  return server;
}

}  // namespace lipofill::testing
