// A USB bus and HID boards for tests: sysfs by umockdev, device nodes by the shim that is preloaded.
#pragma once

#include <dlfcn.h>
#include <umockdev.h>

#include <cstdio>
#include <string>
#include <vector>

#include "tests/device/usb_descriptors.h"
#include "tests/device/usbfs_shim.h"
#include "tests/support/catch.h"

namespace frm::test {

class UsbBus {
public:
    UsbBus() : bed_(umockdev_testbed_new()) {}
    ~UsbBus() {
        // libudev and whoever watches it end before the folder does.
        g_object_unref(bed_);
    }
    UsbBus(const UsbBus&) = delete;
    UsbBus& operator=(const UsbBus&) = delete;

    static bool there() { return dlsym(RTLD_DEFAULT, "frm_shim_plug") && umockdev_in_mock_environment(); }

    /// A simulated amplifier at an address of its own; returns its device node.
    std::string plug_usb(const char* amplifier, unsigned rotary) {
        const unsigned address = next_address()++;
        const unsigned product = std::string(amplifier) == "simple" ? 0x0203 : 0x0205;
        char node[40], text[4096];
        std::snprintf(node, sizeof node, "bus/usb/001/%03u", address);
        std::snprintf(
            text, sizeof text,
            "P: /devices/pci0000:00/0000:00:14.0/usb1/1-%u\nN: %s\nE: DEVNAME=/dev/%s\nE: DEVTYPE=usb_device\n"
            "E: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=%03u\nE: MAJOR=189\nE: MINOR=%u\n"
            "A: busnum=1\\n\nA: devnum=%u\\n\nA: bConfigurationValue=1\\n\nA: speed=480\\n\n"
            "A: idVendor=0cec\\n\nA: idProduct=%04x\\n\nH: descriptors=%s\n",
            address, node, node, address, address - 1, address, product,
            hexadecimal(usb_descriptors(0x0cec, product)).c_str());
        add(text);
        const std::string path = std::string("/dev/") + node;
        function<void(const char*, int, const char*, unsigned)>("frm_shim_plug")(path.c_str(), 0, amplifier, rotary);
        return path;
    }

    std::string plug_hid(unsigned rotary) {
        const unsigned address = next_address()++;
        char text[4096];
        const std::string usb = "/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(address);
        std::snprintf(
            text, sizeof text,
            "P: %s\nN: bus/usb/001/%03u\nE: DEVTYPE=usb_device\nE: SUBSYSTEM=usb\nA: busnum=1\\n\nA: devnum=%u\\n\n"
            "A: idVendor=04d8\\n\nA: idProduct=003f\\n\nA: bcdDevice=0100\\n\nA: manufacturer=frm\\n\nA: "
            "product=mock\\n\n"
            "A: bConfigurationValue=1\\n\nA: speed=12\\n\nH: descriptors=%s\n",
            usb.c_str(), address, address, hexadecimal(usb_descriptors(0x04d8, 0x003F)).c_str());
        add(text);
        const std::string interface = usb + "/1-" + std::to_string(address) + ":1.0";
        add("P: " + interface + "\nE: DEVTYPE=usb_interface\nE: SUBSYSTEM=usb\nA: bInterfaceNumber=00\\n\n");
        const std::string hid = interface + "/0003:04D8:003F.0001";
        add("P: " + hid +
            "\nE: SUBSYSTEM=hid\nE: HID_ID=0003:000004D8:0000003F\nE: HID_NAME=frm mock\nE: HID_UNIQ=1\n" +
            "H: report_descriptor=" + hexadecimal({frm_shim_report_descriptor, std::end(frm_shim_report_descriptor)}) +
            "\n");
        const std::string node = "hidraw" + std::to_string(address);
        add("P: " + hid + "/hidraw/" + node + "\nN: " + node + "\nE: DEVNAME=/dev/" + node +
            "\nL: device=../../../0003:04D8:003F.0001\nE: SUBSYSTEM=hidraw\nE: MAJOR=240\nE: MINOR=" +
            std::to_string(address) + "\n");
        const std::string path = "/dev/" + node;
        function<void(const char*, int, const char*, unsigned)>("frm_shim_plug")(path.c_str(), 1, "simple", rotary);
        return path;
    }

    static void set_fault(const std::string& path, int fault) {
        function<void(const char*, int)>("frm_shim_set_fault")(path.c_str(), fault);
    }
    static void centre(const std::string& path) { function<void(const char*)>("frm_shim_centre")(path.c_str()); }
    static frm_shim_view look(const std::string& path) {
        frm_shim_view view{};
        function<void(const char*, frm_shim_view*)>("frm_shim_look")(path.c_str(), &view);
        return view;
    }

private:
    template <typename F>
    static F* function(const char* name) {
        return reinterpret_cast<F*>(dlsym(RTLD_DEFAULT, name));
    }

    static unsigned& next_address() {
        static unsigned next = 2;
        return next;
    }

    void add(const std::string& text) {
        GError* error = nullptr;
        if (umockdev_testbed_add_from_string(bed_, text.c_str(), &error)) return;
        const std::string what = error ? error->message : "?";
        g_clear_error(&error);
        FAIL("umockdev: " << what << "\n" << text);
    }

    static std::string hexadecimal(const std::vector<std::uint8_t>& bytes) {
        std::string out;
        for (const std::uint8_t b : bytes) {
            char digits[3];
            std::snprintf(digits, sizeof digits, "%02X", static_cast<unsigned>(b));
            out += digits;
        }
        return out;
    }

    UMockdevTestbed* bed_;
};

}  // namespace frm::test
