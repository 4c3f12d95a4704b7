#!/usr/bin/env python3
"""Watches a session that `lorica serve` shows: prints where each avatar's first joint is, and a hash of where all are,
to compare what two clients got. Only Python's own library.

  lorica serve walk &
  python3 watch_session.py [HOST:PORT] [FRAMES]
"""
import base64, hashlib, json, os, socket, struct, sys

address = sys.argv[1] if len(sys.argv) > 1 else "127.0.0.1:8420"
wanted = int(sys.argv[2]) if len(sys.argv) > 2 else 100
host, port = address.rsplit(":", 1)
stream = socket.create_connection((host, int(port))).makefile("rwb")
stream.write((f"GET /live HTTP/1.1\r\nHost: {address}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
              f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n"
              "Sec-WebSocket-Protocol: lorica.live.1\r\n\r\n").encode())
stream.flush()
if b" 101 " not in stream.readline():
    sys.exit(f"{address} is no Lorica that serves")
while stream.readline() != b"\r\n":
    pass

def receive():
    head = stream.read(2)
    if len(head) < 2:
        sys.exit("the connection has broken off")
    kind, length = head
    if length >= 126:
        length = int.from_bytes(stream.read(2 if length == 126 else 8), "big")
    return kind & 15, stream.read(length)

def send(kind, text):  # at most 125 bytes; clients mask theirs
    mask = os.urandom(4)
    stream.write(bytes([0x80 | kind, 0x80 | len(text)]) + mask + bytes(c ^ mask[i % 4] for i, c in enumerate(text)))
    stream.flush()

while wanted > 0:
    kind, data = receive()
    if kind == 8:
        break
    if kind == 9:  # the server asks whether somebody is there, when nothing was said for a while
        send(10, data)
    if kind == 1 and json.loads(data)["type"] == "hello":
        print("hello:", json.loads(data)["name"])
    if kind != 2:
        continue
    magic, version, sections, run, props, number, time = struct.unpack_from("<4sHHIIQd", data)
    at = 32
    for _ in range(sections):
        section, index, length = struct.unpack_from("<HHI", data, at)
        if section == 1:
            present, form, joints, opacity = struct.unpack_from("<BBHf", data, at + 8)
            floats, place = ("12f", slice(3, 12, 4)) if form == 1 else ("3f8x", slice(3))  # a matrix or a pose
            each = struct.Struct("<" + floats)
            places = [each.unpack_from(data, at + 16 + each.size * j)[place] for j in range(joints)]
            hashed = hashlib.sha256(b"".join(struct.pack("<3f", *xyz) for xyz in places)).hexdigest()[:16]
            x, y, z = places[0]
            print(f"{time:.3f} s, {len(data)} bytes: avatar {index} at {x:.3f} {y:.3f} {z:.3f}, joints {hashed}")
        at += 8 + (length + 3) // 4 * 4
    send(1, json.dumps({"type": "ack", "frame": number}).encode())
    wanted -= 1
