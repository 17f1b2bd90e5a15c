/* What a test tells the shim that is preloaded (usbfs_shim.cpp). */
#pragma once

#include <cstdint>

enum {
    FRM_SHIM_GOOD = 0,
    FRM_SHIM_SILENT = 1, /* no answer */
    FRM_SHIM_STALL = 2,
    FRM_SHIM_SHORT = 3, /* half an answer */
    FRM_SHIM_GONE = 4   /* unplugged; there is no way back */
};

/* Bytes of a HID report. */
enum { FRM_SHIM_REPORT = 64 };

/* One kind of report, without a number, of so many bytes each way, on a page of the vendor's own. */
constexpr std::uint8_t frm_shim_report_descriptor[] = {0x06, 0x00,
                                                       0xFF, 0x09,
                                                       0x01, 0xA1,
                                                       0x01, 0x15,
                                                       0x00, 0x26,
                                                       0xFF, 0x00,
                                                       0x75, 0x08,
                                                       0x95, FRM_SHIM_REPORT,
                                                       0x09, 0x02,
                                                       0x81, 0x02,
                                                       0x95, FRM_SHIM_REPORT,
                                                       0x09, 0x03,
                                                       0x91, 0x02,
                                                       0xC0};

struct frm_shim_view {
    std::uint64_t cycles;
    double tensions[8]; /* N, as the DAC says */
    double position[3]; /* of the grip, m, y up */
};

/* Plugs a simulated amplifier ("sh4" or "simple") in at a device node. */
extern "C" void frm_shim_plug(const char* path, int hid, const char* amplifier, unsigned rotary);
extern "C" void frm_shim_set_fault(const char* path, int fault);
/* Puts the grip where it is calibrated, at rest. */
extern "C" void frm_shim_centre(const char* path);
extern "C" void frm_shim_look(const char* path, frm_shim_view* view);
