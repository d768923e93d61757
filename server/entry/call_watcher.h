#pragma once

#include <grpcpp/support/server_interceptor.h>

#include "server/entry/call_gate.h"
#include "server/ops/metrics.h"

namespace lipofill::server {

/// The one place that every call passes, unary or streaming, of every service, before and after it
/// is carried out: reads what is known of it (Call), has the gate say whether it may be carried out
/// and told how it ended, answers with its x-request-id, counts it, and writes one line to the log
/// when it ends: method, code, duration_ms and the fields of Call.
///
/// gRPC does not let it answer in place of a method: what it refuses is noted in Call::refusal, and
/// check_call() (server/entry/unary.h), with which every method begins, turns that into the answer.
/// Checked by tests/integration/service/calls_test.cc.
class CallWatchers : public grpc::experimental::ServerInterceptorFactoryInterface {
 public:
  CallWatchers(Metrics& metrics, CallGate& gate) : metrics_(metrics), gate_(gate) {}

  grpc::experimental::Interceptor* CreateServerInterceptor(grpc::experimental::ServerRpcInfo* info) override;

 private:
  Metrics& metrics_;
  CallGate& gate_;
};

}  // namespace lipofill::server
