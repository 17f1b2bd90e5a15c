#!/usr/bin/python3
"""A device of a host's own, in Python: the grip goes where lines of "x y" (metres) on standard input say, and what it
is to feel is printed. As samples/host_device.c, which says more.

    printf '0 0\\n0 0.002\\n0 0.004\\n' | PYTHONPATH=bindings/python samples/host_device.py paddle.frm
"""
import sys

import frm

CYCLE_NS = 2_000_000  # 500 lines a second


class Mouse(frm.Driver):
    """A driver; what stands above it (limits, ramp, faults) is the library's."""

    def __init__(self, lines):
        self.lines, self.cycles, self.place, self.felt = lines, 0, None, (0.0, 0.0)

    def enumerate(self):
        return [frm.DeviceInfo(name=b"mouse", max_force=10, max_torque=1, period_ns=CYCLE_NS)]

    def open(self, index):
        return self

    def info(self, instance):
        return self.enumerate()[0]

    def exchange(self, instance, command, state):
        self.felt = (command.wrench.force.x, command.wrench.force.y)
        x, y = map(float, next(self.lines).split())
        last_x, last_y = self.place or (x, y)
        self.place = (x, y)
        state.status = frm.DEVICE_READY
        state.pose = frm.Pose((x, y, 0), (0, 0, 0, 1))
        state.twist = frm.Twist(((x - last_x) * 1e9 / CYCLE_NS, (y - last_y) * 1e9 / CYCLE_NS, 0), (0, 0, 0))
        state.sequence = self.cycles
        state.time_ns = self.cycles * CYCLE_NS  # time must run, or the device is taken for broken
        self.cycles += 1

    def stop(self, instance):
        self.felt = (0.0, 0.0)


def main(path: str) -> None:
    with frm.Context() as context:
        world = frm.World(context)
        body = frm.Body(world, frm.Map(context, path))
        mouse = Mouse(line for line in sys.stdin if line.strip())
        device = frm.Device(context, mouse)
        device.set_safety(ramp_time=0.02, deadline_ns=10_000_000_000)  # it waits for somebody who types
        device.engage()  # nothing is felt before
        felt, lines = (0.0, 0.0, 0.0), 0
        while True:
            try:
                state = device.exchange((felt, (0, 0, 0)))
            except frm.Error as error:
                if isinstance(error.__cause__, StopIteration):
                    break
                raise
            last = mouse.felt
            place = (state.pose.position.x, state.pose.position.y, -0.3)  # under water
            body.set_motion((place, (0, 0, 0, 1)), state.twist)
            world.tick(CYCLE_NS * 1e-9)
            forces = body.forces()
            felt = (forces.pressure.force.x + forces.friction.force.x, forces.pressure.force.y + forces.friction.force.y, 0)
            lines += 1
        print(f"{lines} lines; felt at the end: {last[0]:.3f} {last[1]:.3f} N")


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else "paddle.frm")
