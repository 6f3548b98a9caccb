"""Speaks MQTT 3.1.1 or 5 with the library paho-mqtt, as a test tells it: the argument says in JSON how to come in and what to follow.
Each line of standard input is a message to be published, in JSON; its end is the time to leave. Prints each message that is heard as
a line of JSON, as `mosquitto_sub -F %j` does, and beside that what becomes of the connection: `Connected`, `Refused: WHY`,
`Subscribed: 1, 128`, `Said` for each message that was handed over (QoS 0) or acknowledged, `Closed`. It never comes back by itself."""

import json
import os
import sys
import threading

import paho.mqtt.client as mqtt
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties

hello = json.loads(sys.argv[1])
leaving = threading.Event()
printing = threading.Lock()


def tell(line):
    with printing:
        print(line, flush=True)


def connected(client, _data, _flags, code, _properties):
    if code.is_failure:
        tell(f"Refused: {code}")
        return
    tell("Connected")
    if hello["follow"]:
        client.subscribe([(topic, qos) for topic, qos in hello["follow"]])


def heard(_client, _data, message):
    tell(json.dumps({
        "topic": message.topic,
        "qos": message.qos,
        "retain": int(message.retain),
        "payload": message.payload.decode("utf-8", "replace"),
    }))


def closed(*_):
    if not leaving.is_set():
        tell("Closed")
        os._exit(0)


five = hello["five"]
client = mqtt.Client(
    mqtt.CallbackAPIVersion.VERSION2,
    client_id=hello["id"],
    clean_session=None if five else not hello["remembered"],
    protocol=mqtt.MQTTv5 if five else mqtt.MQTTv311,
    reconnect_on_failure=False,
)
if hello["name"]:
    client.username_pw_set(hello["name"], hello["password"])
if hello["will"]:
    will = hello["will"]
    client.will_set(will["topic"], will["payload"], will["qos"], will["retain"])
client.on_connect = connected
client.on_message = heard
client.on_disconnect = closed
client.on_subscribe = lambda _client, _data, _id, codes, _properties: tell(
    "Subscribed: " + ", ".join(str(code.value) for code in codes))
client.on_publish = lambda *_: tell("Said")
if five:
    lasting = Properties(PacketTypes.CONNECT)
    lasting.SessionExpiryInterval = 300 if hello["remembered"] else 0
    client.connect(hello["host"], hello["port"], hello["keepalive_s"],
                   clean_start=not hello["remembered"], properties=lasting)
else:
    client.connect(hello["host"], hello["port"], hello["keepalive_s"])
client.loop_start()
for line in sys.stdin:
    say = json.loads(line)
    client.publish(say["topic"], say["payload"], say["qos"], say["retain"])
leaving.set()
client.disconnect()
client.loop_stop()
