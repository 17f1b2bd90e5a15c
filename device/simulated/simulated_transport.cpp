#include "device/simulated/simulated_transport.h"

namespace frm::simulated {

using spidar_g::Carried;

Carried SimulatedTransport::send(const spidar_g::Request& request) {
    if (failing == Carried::unplugged || failing == Carried::refused) return failing;
    for (std::size_t i = 0; i < request.count; ++i)
        amplifier_.receive(request.packets[i].bytes.data(), request.packets[i].size);
    return Carried::whole;
}

Carried SimulatedTransport::cycle(const spidar_g::Request& request, std::size_t size, spidar_g::Packet& reply) {
    now_ns_ += period_ns_;
    reply.size = 0;
    const Carried sent = send(request);
    if (sent != Carried::whole) return sent;
    if (failing == Carried::too_late || !amplifier_.reply(reply, static_cast<double>(period_ns_) * 1e-9)) {
        reply.size = 0;
        return Carried::too_late;
    }
    if (failing == Carried::cut_off) reply.size /= 2;
    return reply.size < size ? Carried::cut_off : Carried::whole;
}

}  // namespace frm::simulated
