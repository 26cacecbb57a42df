#pragma once
#include <memory>
#include <string>

#include "libperception/packets/Decoder.h"

namespace perception {

/// Velodyne HDL-32E, VLP-16 and VLP-32C (1206 bytes; the model is in the packet; azimuths
/// interpolated by the time of each firing, without vertical offsets of the lasers). Of equal dual
/// returns the first alone. Stamp: past the hour. No packet numbers are sent: they follow from the
/// stamps, as firings never pause. Source: the manuals of the sensors.
std::unique_ptr<PacketDecoder> makeVelodyneDecoder();

/// Hesai Pandar40P and XT32. `file`: beams of the unit, "Laser id,Elevation,Azimuth"; empty: the
/// nominal ones. Stamp: of the packet, since 1970. Source: the manuals of the sensors.
std::unique_ptr<PacketDecoder> makePandar40pDecoder(const std::string& file);
std::unique_ptr<PacketDecoder> makeXt32Decoder(const std::string& file);

/// RoboSense RS-LiDAR-16 and -32, Helios of 16 and 32 beams, and Bpearl: packets of returns (MSOP,
/// 1248 bytes), and of the device (DIFOP, the same size), from which the angles of the unit's beams
/// are taken. `file`: beams of the unit, or one of its DIFOP packets; empty: the nominal ones of
/// the RS-LiDAR-16, none of the others, whose returns are left out until a DIFOP packet came.
/// Big-endian. Distances of 5 mm (Helios: 2.5 mm), as the firmware of today sends them; older ones
/// of the RS-LiDAR-16 sent 10 mm and do not say so. A Bpearl of version 4 is refused. Stamp: of the
/// first firing, since 1970. No packet numbers are sent: what is lost is not seen. Source: the
/// layouts of the manuals and of the maker's public driver, written down without these at hand and
/// not tried on a recording. Other models of the maker have other layouts: refused.
std::unique_ptr<PacketDecoder> makeRs16Decoder(const std::string& file);
std::unique_ptr<PacketDecoder> makeRs32Decoder(const std::string& file);
std::unique_ptr<PacketDecoder> makeHelios16Decoder(const std::string& file);
std::unique_ptr<PacketDecoder> makeHelios32Decoder(const std::string& file);
std::unique_ptr<PacketDecoder> makeBpearlDecoder(const std::string& file);

/// Ouster, with its metadata file. Stamp: by the sensor's timestamp mode. See Ouster.h.
std::unique_ptr<PacketDecoder> makeOusterDecoder(const std::string& file);

/// Continental ARS548: detections and objects. Stamp: since 1970.
std::unique_ptr<PacketDecoder> makeArs548Decoder();

/// Continental SRR520: CAN FD messages, each as four bytes of identifier (big endian) and its data.
/// Near and far detections become targets, and objects objects, with the message that closes the
/// group. Stamp: since 1970.
std::unique_ptr<PacketDecoder> makeSrr520Decoder();

/// Ibeo LUX (2202), ECU (2204, 2205) and ALASCA XT: scans with echo number, pulse width and the
/// sensor's own labels, a message each, with its header. Points of an ECU are in its own frame.
/// Stamp: of the scan's end; since 1970, of the ALASCA XT since it was switched on.
std::unique_ptr<PacketDecoder> makeIbeoDecoder();

/// Delphi ESR 2.5: CAN messages, each as four bytes of identifier (big endian) and its data, laid
/// out as in the public DBC. A scan ends with the last group of powers, or with the next index.
/// Tracks without a measurement in the scan (coasted) are left out. No stamp is sent; its packets'
/// numbers are those of the scans.
std::unique_ptr<PacketDecoder> makeEsrDecoder();

/// Continental ARS 408 by CAN: clusters (0x600, 0x701), or objects (0x60A, 0x60B) where it is set
/// to send these, each frame as four bytes of identifier (big endian) and its data. Of several on
/// a bus (16 more for each) the first that is heard. A list ends with the element that its head
/// announces as the last, or with the next head. No stamp is sent. Source: the technical
/// documentation of the radar, as public drivers have it; no recording was at hand.
std::unique_ptr<PacketDecoder> makeArs408Decoder();

}  // namespace perception
