"""Reads a Coronet log with the public MCAP and protobuf readers only and prints what it found as
JSON. Every message is decoded; particles are unpacked by the field table in each message.

usage: read_log.py LOG
needs: mcap, mcap-protobuf-support
"""

import json
import struct
import sys

from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

# foxglove.PackedElementField.NumericType
FORMATS = {1: "B", 2: "b", 3: "H", 4: "h", 5: "I", 6: "i", 7: "f", 8: "d"}


def columns(cloud):
    """Values of each field of a point cloud, by name."""
    count, rest = divmod(len(cloud.data), cloud.point_stride)
    if rest:
        raise ValueError("the data are no whole number of points")
    values = {}
    for field in cloud.fields:
        unpack = struct.Struct("<" + FORMATS[field.type]).unpack_from
        starts = range(field.offset, field.offset + count * cloud.point_stride, cloud.point_stride)
        values[field.name] = [unpack(cloud.data, start)[0] for start in starts]
    return values


def main(path):
    found = {"clouds": {}, "measures": [], "figures": [], "transforms": [], "schemas": {}}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()], validate_crcs=True)
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            found["schemas"][channel.topic] = schema.name
            if schema.name == "foxglove.PointCloud":
                values = columns(decoded)
                stamp = decoded.timestamp.seconds * 10**9 + decoded.timestamp.nanos
                if stamp != message.log_time:
                    raise ValueError(f"timestamp {stamp}, log time {message.log_time}")
                fresh = {"counts": [], "id_sums": [], "x_sums": []}
                cloud = found["clouds"].setdefault(channel.topic, fresh)
                cloud["fields"] = list(values)
                cloud["frame"] = decoded.frame_id
                cloud["counts"].append(len(values["x"]))
                cloud["id_sums"].append(sum(values.get("id", [])))
                cloud["x_sums"].append(sum(values["x"]))
            elif channel.topic in ("/measures", "/figures"):
                names = [field.name for field in decoded.DESCRIPTOR.fields]
                kind = channel.topic[1:]
                found[kind[:-1] + "_names"] = names
                values = [getattr(decoded, name) for name in names]
                # JSON has no NaN.
                found[kind].append([None if v != v else v for v in values])
            elif schema.name == "foxglove.FrameTransform":
                found["transforms"].append([decoded.parent_frame_id, decoded.child_frame_id])
        found["attachments"] = {a.name: a.data.decode() for a in reader.iter_attachments()}
        found["metadata"] = {m.name: m.metadata for m in reader.iter_metadata()}
        found["message_count"] = reader.get_summary().statistics.message_count
    json.dump(found, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1])
