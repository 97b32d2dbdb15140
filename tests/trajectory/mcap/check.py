# Checks that the index and the statistics of an MCAP file agree with its records, with all
# checksums, and that its schemas are Foxglove's. The fields of other schemas are our own.
import importlib, struct, sys
from collections import Counter
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from mcap.records import Channel, Chunk, ChunkIndex, DataEnd, Footer, Message, MessageIndex, Schema, Statistics
from mcap.stream_reader import StreamReader, breakup_chunk

schemas, channels, counts, times = {}, {}, Counter(), []
chunks, chunk_count, repeated, in_summary = {}, 0, set(), False


def places(chunk):
    """The place of each message in a chunk."""
    found, place = {}, 0
    while place < len(chunk.data):
        opcode, length = struct.unpack_from("<BQ", chunk.data, place)
        if opcode == 5:
            channel, _, time = struct.unpack_from("<HIQ", chunk.data, place + 9)
            found.setdefault(channel, []).append((time, place))
        place += 9 + length
    return found


def take(record):
    """Takes a record that can be in a chunk."""
    if isinstance(record, Schema):
        assert record.id != 0 and schemas.setdefault(record.id, record) == record
    elif isinstance(record, Channel):
        assert record.schema_id in schemas and channels.setdefault(record.id, record) == record
    elif isinstance(record, Message):
        assert record.channel_id in channels and record.log_time == record.publish_time
        counts[record.channel_id] += 1
        times.append(record.log_time)


with open(sys.argv[1], "rb") as file:
    start = 8
    for record in StreamReader(file, emit_chunks=True, validate_crcs=True).records:
        end = file.tell()
        take(record)
        if isinstance(record, Chunk):
            assert not in_summary and record.compression == "" and record.uncompressed_crc != 0
            first = len(times)
            for part in breakup_chunk(record, validate_crc=True):
                take(part)
            inside = times[first:]
            assert (record.message_start_time, record.message_end_time) == (min(inside, default=0), max(inside, default=0))
            chunk_count += 1
            chunks[start] = (end - start, record, places(record))
            messages = dict(chunks[start][2])
        elif isinstance(record, MessageIndex):
            assert [tuple(entry) for entry in record.records] == messages.pop(record.channel_id)
        elif isinstance(record, DataEnd):
            assert record.data_section_crc != 0
            in_summary = True
        elif in_summary and isinstance(record, (Schema, Channel)):
            repeated.add((type(record), record.id))
        elif isinstance(record, ChunkIndex):
            length, chunk, found = chunks.pop(record.chunk_start_offset)
            assert (record.chunk_length, set(record.message_index_offsets)) == (length, set(found))
            for name in ["message_start_time", "message_end_time", "compression", "uncompressed_size"]:
                assert getattr(record, name) == getattr(chunk, name), name
        elif isinstance(record, Statistics):
            assert (record.message_count, record.chunk_count) == (len(times), chunk_count)
            assert (record.schema_count, record.channel_count) == (len(schemas), len(channels))
            assert (record.message_start_time, record.message_end_time) == (min(times, default=0), max(times, default=0))
            assert record.channel_message_counts == dict(counts)
        elif isinstance(record, Footer):
            assert record.summary_crc != 0
        start = end
assert not chunks, "a chunk is not in the index"
for channel in counts:
    assert {(Channel, channel), (Schema, channels[channel].schema_id)} <= repeated, "missing in the summary"

for schema in schemas.values():
    if schema.name.startswith("foxglove."):
        for file in FileDescriptorSet.FromString(schema.data).file:
            for message in file.message_type if file.package == "foxglove" else []:
                module = importlib.import_module(f"foxglove_schemas_protobuf.{message.name}_pb2")
                official = getattr(module, message.name).DESCRIPTOR.fields_by_name
                for field in message.field:
                    other = official[field.name]
                    assert (field.number, field.type) == (other.number, other.type), field
                    assert (field.label == 3) == other.is_repeated, field
                    assert field.type_name == (f".{other.message_type.full_name}" if other.message_type else "")
