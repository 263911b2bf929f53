#include "server/apps/commands/fly/pdu_source.h"

#include <fmt/core.h>

#include <cstdio>

#include "server/apps/commands/fly/fly_datagrams.h"
#include "server/apps/commands/fly/fly_news.h"
#include "server/apps/commands/fly/udp_socket.h"
#include "server/security/networks.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr int kDisPort = 3000;  // IEEE 1278.2-2015, 5.6

UniqueFd listening(const DatagramSource& source, const std::string& name) {
  for (const std::string& network : source.allow)
    if (!security::is_network(network))
      throw InputError(fmt::format(
          "--allow: found \"{}\"; allowed: an address or a network, such as \"10.0.0.0/24\"", network));
  int port = 0;
  UniqueFd socket = bind_udp(source.address, source.interface,
                             source.udp_port >= 0 ? source.udp_port : kDisPort, source.is_dis(), port);
  std::printf("%s: listening on %s:%d\n", name.c_str(), source.address.c_str(), port);
  std::fflush(stdout);
  return socket;
}

}  // namespace

PduSource::PduSource(const DatagramSource& source, const std::string& name)
    : source_(source), inbox_(listening(source, name), source.allow), clock_(source.clock == "absolute") {}

void PduSource::take(std::chrono::milliseconds longest, FlyNews& news, const Taker& taker) {
  const Datagrams came = inbox_.take(longest);
  const auto is_of_exercise = [&](int exercise) {
    return source_.exercise < 0 || exercise == source_.exercise;
  };
  const auto give = [&](const Pdu& pdu, Time stamped, Time arrived) {
    ++understood_;
    taker(pdu, stamped, arrived);
  };
  for (const Datagrams::One& one : came.all) {
    std::span<const std::byte> rest = came.of(one);
    do {
      const Pdu pdu = read_pdu(take_pdu(rest));
      if (const auto* none = std::get_if<NoPose>(&pdu)) {
        news.refuse(none->why);
      } else if (const auto* order = std::get_if<SimulationOrder>(&pdu)) {
        if (is_of_exercise(order->exercise)) give(pdu, one.arrived, one.arrived);
      } else if (const auto& state = std::get<EntityState>(pdu); is_of_exercise(state.exercise)) {
        give(pdu, clock_.moment(state.timestamp, one.arrived, one.utc), one.arrived);
      }
    } while (!rest.empty());
  }
}

std::string PduSource::understood() const { return counted(understood_, "PDU") + " understood"; }

std::string PduSource::losses() const {
  std::string text = fmt::format(", {} datagrams lost", inbox_.lost());
  if (inbox_.not_allowed() > 0)
    text += fmt::format(", {} datagrams from networks that --allow does not name", inbox_.not_allowed());
  if (clock_.arrivals() > 0)
    text += fmt::format(", {} PDUs taken by their arrival, without a near absolute time", clock_.arrivals());
  return text;
}

}  // namespace obliq
