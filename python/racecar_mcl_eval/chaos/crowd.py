"""Many subscribers of one topic in a process: rospy shares a connection, these have one each."""
import os
import selectors
import socket
import struct
import xmlrpc.client

RECEIVED = 65536  # bytes, read at once
SMALL_BUFFER = 4096  # bytes
CALLER = "/crowd"


def connection_header(fields):
    """A TCPROS connection header: its length, and each "key=value" after its length."""
    content = b"".join(struct.pack("<I", len(field)) + field
                       for field in (f"{key}={value}".encode() for key, value in fields.items()))
    return struct.pack("<I", len(content)) + content


def subscribe(topic, environment, buffer_size=None):
    """A socket on which the first publisher of a topic sends it, with a receive buffer of `buffer_size` bytes."""
    master = xmlrpc.client.ServerProxy(environment["ROS_MASTER_URI"])
    publishers = dict(master.getSystemState(CALLER)[2][0])[topic]
    publisher = xmlrpc.client.ServerProxy(master.lookupNode(CALLER, publishers[0])[2])
    _, host, port = publisher.requestTopic(CALLER, topic, [["TCPROS"]])[2]
    connection = socket.socket()
    if buffer_size is not None:
        # Before connecting: it limits the window that is announced to the publisher.
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer_size)
    connection.connect((host, port))
    connection.sendall(connection_header({"callerid": CALLER, "topic": topic, "type": "*", "md5sum": "*"}))
    return connection


def read_and_ignore(topics, count, environment, answer):
    """Subscribes `count` times, to the topics by turns, and reads; and once more to each topic, without ever
    reading. Sends the number of connections to the pipe `answer` as soon as all are connected."""
    os.environ.update(environment)
    selector = selectors.DefaultSelector()
    for index in range(count):
        selector.register(subscribe(topics[index % len(topics)], environment), selectors.EVENT_READ)
    # With a small buffer, so that the publisher soon has to queue or drop.
    ignored = [subscribe(topic, environment, SMALL_BUFFER) for topic in topics]
    answer.send(len(ignored) + count)
    while True:
        for key, _ in selector.select():
            key.fileobj.recv(RECEIVED)
