"""Does with the library paho-mqtt what only MQTT 5 can: the arguments are the address and the port of a broker that is open to this
machine. Prints `ok` and a name for each thing that was as it should be; ends with an error at the first that was not."""

import json
import queue
import sys

import paho.mqtt.client as mqtt
from paho.mqtt.packettypes import PacketTypes
from paho.mqtt.properties import Properties
from paho.mqtt.subscribeoptions import SubscribeOptions

HOST, PORT = sys.argv[1], int(sys.argv[2])
PATIENCE_S = 60
OURS = "hallsweep/discovery/"


def properties(kind, **named):
    made = Properties(kind)
    for name, value in named.items():
        setattr(made, name, value)
    return made


class Client:
    """A client whose callbacks end in queues, so that a check can wait for them in order."""

    def __init__(self, client_id="", keepalive=60, clean_start=True, **of_connect):
        self.connected, self.messages, self.codes, self.ended = (queue.Queue() for _ in range(4))
        self.published = {}
        self.mqtt = mqtt.Client(mqtt.CallbackAPIVersion.VERSION2, client_id, protocol=mqtt.MQTTv5, reconnect_on_failure=False)
        self.mqtt.on_connect = lambda _c, _d, flags, code, props: self.connected.put((flags, code, props))
        self.mqtt.on_message = lambda _c, _d, message: self.messages.put(message)
        self.mqtt.on_subscribe = lambda _c, _d, _id, codes, _p: self.codes.put([code.value for code in codes])
        self.mqtt.on_publish = lambda _c, _d, mid, code, _p: self.published.__setitem__(mid, code.value)
        self.mqtt.on_disconnect = lambda _c, _d, _flags, code, _p: self.ended.put(code.value)
        if "will" in of_connect:
            topic, delay_s = of_connect.pop("will")
            self.mqtt.will_set(topic, "gone", 1, False, properties(PacketTypes.WILLMESSAGE, WillDelayInterval=delay_s))
        self.mqtt.connect(HOST, PORT, keepalive, clean_start=clean_start, properties=properties(PacketTypes.CONNECT, **of_connect))
        self.mqtt.loop_start()
        self.flags, self.code, self.properties = self.connected.get(timeout=PATIENCE_S)

    def subscribe(self, topic, qos=1, **options):
        of_packet = options.pop("of_packet", None)
        self.mqtt.subscribe(topic, options=SubscribeOptions(qos=qos, **options), properties=of_packet)
        return self.codes.get(timeout=PATIENCE_S)[0]

    def publish(self, topic, payload, qos=1, retain=False, **named):
        """Waits for the acknowledgement: its reason code."""
        sent = self.mqtt.publish(topic, payload, qos, retain, properties(PacketTypes.PUBLISH, **named))
        sent.wait_for_publish(PATIENCE_S)
        return self.published.get(sent.mid)

    def next(self):
        return self.messages.get(timeout=PATIENCE_S)

    def on(self, topic):
        """The next message on this topic."""
        while True:
            message = self.next()
            if message.topic == topic:
                return message

    def leave(self, **named):
        self.mqtt.disconnect(properties=properties(PacketTypes.DISCONNECT, **named))
        self.ended.get(timeout=PATIENCE_S)
        self.mqtt.loop_stop()

    def break_off(self):
        """Goes without a word."""
        self.mqtt.loop_stop()
        self.mqtt._sock_close()


def check(expected, got):
    assert expected == got, f"{got!r} where {expected!r} was expected"


def what_is_said_beside_a_message_arrives():
    one, other = Client(), Client()
    check(1, other.subscribe("site/#"))
    said = dict(PayloadFormatIndicator=1, ContentType="text/plain", ResponseTopic="site/answer", CorrelationData=b"7",
                MessageExpiryInterval=60, UserProperty=[("a", "b"), ("a", "c")])
    check(0, one.publish("site/x", "hi", **said))
    got = other.next().properties
    for name, value in said.items():
        check(value, getattr(got, name))
    one.leave()
    other.leave()


def states_tell_their_revision():
    client = Client()
    client.subscribe(OURS + "state/robot")
    message = client.next()
    check("application/json", message.properties.ContentType)
    check([("revision", str(json.loads(message.payload)["revision"]))], message.properties.UserProperty)
    client.leave()


def a_command_is_answered_where_its_sender_wants_it():
    client = Client()
    client.subscribe("site/answers")
    client.subscribe(OURS + "command/+/result")
    wanted = dict(ResponseTopic="site/answers", CorrelationData=b"k\x00")
    for name, payload, accepted in [("strategy", '{"name":"snail"}', True), ("stop", "", True), ("dance", "{}", False)]:
        client.publish(OURS + "command/" + name, payload, **wanted)
        answer = client.next()
        check(("site/answers", b"k\x00", accepted), (answer.topic, answer.properties.CorrelationData, json.loads(answer.payload)["accepted"]))
        assert ("by", "operator") in answer.properties.UserProperty, answer.properties.UserProperty
    # Nobody lets the program say something where only the program speaks.
    client.publish(OURS + "command/stop", "", ResponseTopic=OURS + "state/robot", CorrelationData=b"k")
    answer = client.next()
    check(OURS + "command/stop/result", answer.topic)
    assert not hasattr(answer.properties, "CorrelationData")
    client.leave()


def a_subscription_is_shared_but_not_one_to_what_the_program_says():
    members, writer = [Client(), Client()], Client()
    for member in members:
        check(1, member.subscribe("$share/workers/site/work"))
    for refused in ["$share/workers/#", "$share/workers/" + OURS + "event"]:
        check(0x9E, members[0].subscribe(refused))
    for number in range(10):
        writer.publish("site/work", str(number))
    got = [sorted(member.next().payload for _ in range(5)) for member in members]
    check([str(number).encode() for number in range(10)], sorted(got[0] + got[1]))
    for client in members + [writer]:
        client.leave()


def options_of_a_subscription_hold():
    client = Client()
    numbered = properties(PacketTypes.SUBSCRIBE, SubscriptionIdentifier=300)
    client.publish("site/kept", "1", retain=True)
    client.subscribe("site/+", of_packet=numbered, retainAsPublished=True, retainHandling=SubscribeOptions.RETAIN_DO_NOT_SEND)
    client.subscribe("site/own", noLocal=True)
    client.publish("site/kept", "2", retain=True)
    message = client.next()
    check((b"2", True, [300]), (message.payload, bool(message.retain), message.properties.SubscriptionIdentifier))
    client.publish("site/kept", "", retain=True)
    client.leave()


def a_client_is_remembered_as_long_as_it_says():
    writer = Client()
    for lasts_s, is_remembered in [(300, True), (0, False)]:
        first = Client("night-shift", SessionExpiryInterval=300)
        first.subscribe("site/news")
        first.leave(SessionExpiryInterval=lasts_s)
        writer.publish("site/news", "meanwhile")
        second = Client("night-shift", clean_start=False, SessionExpiryInterval=300)
        check(is_remembered, second.flags.session_present)
        if is_remembered:
            check(b"meanwhile", second.next().payload)
        second.leave(SessionExpiryInterval=0)
    writer.leave()


def a_will_waits_and_is_taken_back_by_whoever_comes_again():
    witness = Client()
    witness.subscribe("site/will/#")
    for client_id, delay_s in [("back", 200), ("lost", 1)]:
        Client(client_id, will=("site/will/" + client_id, delay_s), SessionExpiryInterval=300).break_off()
    back = Client("back", clean_start=False, SessionExpiryInterval=300)
    check("site/will/lost", witness.next().topic)
    back.leave()
    check(True, witness.messages.empty())
    witness.leave()


def whoever_is_sent_away_or_refused_is_told_why():
    first, second = Client("twin"), Client("twin")
    check(0x8E, first.ended.get(timeout=PATIENCE_S))
    check(0x10, second.publish("site/nobody", "x"))
    check(0x87, second.publish(OURS + "state/robot", "forged"))
    check(0x8F, second.subscribe("$SYS/#"))
    second.leave()
    refused = Client(AuthenticationMethod="SCRAM-SHA-1")
    check(0x8C, refused.code.value)


def a_client_without_a_name_or_a_keep_alive_is_given_one():
    client = Client(keepalive=0)
    assert client.properties.AssignedClientIdentifier.startswith("hallsweep-"), client.properties
    check((57600, 4096, 262144, 10), (client.properties.ServerKeepAlive, client.properties.ReceiveMaximum,
                                      client.properties.MaximumPacketSize, client.properties.TopicAliasMaximum))
    client.leave()


def a_number_stands_for_a_topic():
    client = Client(TopicAliasMaximum=5)
    client.subscribe("site/a/long/topic")
    client.publish("site/a/long/topic", "1", TopicAlias=3)
    check(b"1", client.next().payload)
    client.mqtt.publish("", "2", 1, properties=properties(PacketTypes.PUBLISH, TopicAlias=3))
    message = client.next()
    check((b"2", ""), (message.payload, message.topic))
    check(1, message.properties.TopicAlias)
    client.leave()


for scenario in [
    what_is_said_beside_a_message_arrives,
    states_tell_their_revision,
    a_command_is_answered_where_its_sender_wants_it,
    a_subscription_is_shared_but_not_one_to_what_the_program_says,
    options_of_a_subscription_hold,
    a_client_is_remembered_as_long_as_it_says,
    a_will_waits_and_is_taken_back_by_whoever_comes_again,
    whoever_is_sent_away_or_refused_is_told_why,
    a_client_without_a_name_or_a_keep_alive_is_given_one,
    a_number_stands_for_a_topic,
]:
    scenario()
    print("ok", scenario.__name__, flush=True)
