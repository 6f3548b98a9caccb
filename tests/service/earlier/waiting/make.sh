# Commands that made this folder with the program of commit bf92f3ec (see ../README.md).
set -e
export TZ=UTC HALLSWEEP__HTTP__BIND=127.0.0.1:21480 HALLSWEEP__HTTP__REQUIRE_TOKEN=true
export HALLSWEEP__STORE__FOLDER=$PWD/data HALLSWEEP__COAP__BIND=none HALLSWEEP__MQTT__BIND=none
for key in anna:operator ben:operator lobby:viewer; do hallsweep token add ${key%:*} --role ${key#*:}; done
serve() {
    hallsweep serve --hall "$1" --seed 7 --speed max &
    until curl -s -o /dev/null 127.0.0.1:21480/healthz; do sleep 0.2; done
    wait_for '(.mission.holds | index("robotLink")) == null'
}
ask() {
    token=$(hallsweep token | grep -A1 "^$1 " | sed -n 's/ *token *//p')
    curl -s -H "Authorization: Bearer $token" -H 'Content-Type: application/json' -X "$2" ${4:+-d "$4"} "127.0.0.1:21480/api/v1/$3"
    echo
}
wait_for() { until ask anna GET state | jq -e "$1" >/dev/null; do sleep 0.2; done; }
asked='(.mission.refusals.retake == null) and any(.luggage[]; .verdict == "pending")'
end() { kill %hallsweep && wait; }

serve empty-8x8
ask ben POST commands/start
wait_for '.mission.phase == "explored"'
ask ben POST commands/reset
end
hallsweep journal archive --before 2999-01-01 -o archived.hallsweep
hallsweep report 1 --language it -o 1.it.html --data archived.hallsweep

serve seed
ask anna POST commands/start
wait_for "$asked"
ask anna POST luggage/1/verdict '{"verdict":"safe","note":"aperta: è vuota"}'
wait_for "$asked"
ask lobby POST commands/stop
ask lobby POST luggage/2/verdict '{"verdict":"safe"}'
ask ben POST luggage/1/verdict '{"verdict":"danger"}'
ask ben POST luggage/2/verdict '{"verdict":"danger","note":"wires under the lid"}'
ask anna POST commands/start
wait_for '.mission.phase == "bombLocated"'
ask anna POST alarms/1/acknowledge
ask ben POST commands/retrieve
wait_for '.mission.phase == "bagSecured"'
ask anna PUT temperature '{"celsius":21.5}'
ask ben POST commands/reset
ask anna POST commands/start
wait_for "$asked"
end
hallsweep report 2 -o 2.en.html
hallsweep journal export > journal.jsonl

rm -f data/journal.db-* data/journal.lock

cp -r data shown && HALLSWEEP__STORE__FOLDER=$PWD/shown HALLSWEEP__HTTP__REQUIRE_TOKEN=false serve seed
ask anna GET state > state.json
ask anna GET missions > missions.json
python3 - <<'END'
import json

def bare(value):
    if isinstance(value, dict):
        return {name: bare(field) for name, field in value.items() if name not in ("revision", "run", "log")}
    return [bare(item) for item in value] if isinstance(value, list) else value

state, missions = (bare(json.load(open(f"{name}.json"))) for name in ("state", "missions"))
json.dump({"state": state, "missions": missions["missions"]}, open("shown.json", "w"), indent=1)
END
end
rm -r shown state.json missions.json
