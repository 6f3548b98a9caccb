# La console dell'operatore.

## The bar and the frame

skip = A ciò che attende e ai comandi
revision = rev
sign-out = Uscire
lost = <b>Collegamento perso.</b> Quello che si vede è delle <span id="lost-since"></span> e può non essere più vero. STOP viene tentato lo stesso.
viewer-notice = Accesso come osservatore: si vede tutto e si può premere STOP. Per tutto il resto serve la chiave di un operatore.
no-scripts = Gli script sono disattivati: questa pagina mostra com'era il <b>{ $time }</b>.
look-again = Guardare di nuovo
live-loaded = com'era
live-opening = si collega
live-on = in diretta
live-lost = perso
live-unlinked = solo pagina
not-known = non si sa
unknown-since = non si sa dalle { $time }; ultimo dato: { $last }
side = Che cosa serve, comandi, bagagli e cronaca
laboratory = laboratorio
simulator = simulatore
colours = Colori
colours-system = come il sistema
colours-light = chiari
colours-dark = scuri
keys-open = tasti (?)
no-emergency-stop = STOP in questa pagina è un arresto operativo e non di emergenza: tenere a portata di mano l'interruttore del robot.
hall = Sala
hall-known = La sala per quanto è nota
lens = Parte della sala che si vede
lens-closer = Più vicino
lens-closer-key = più vicino (+)
lens-wider = Più lontano
lens-wider-key = più lontano (−)
lens-whole = Tutta la sala
lens-whole-key = tutta la sala (0)
legend = Legenda
go-back = No, tornare indietro
past-now = <b>Passato:</b> com'era alle { $time }
goal-short = → meta { $cell }
halted = fermo
led = LED { $state }
led-none = assente
led-blinking = lampeggia
led-off = spento
led-unknown = non noto

## Why buttons are dead

dead-viewer = l'accesso è da osservatore
dead-past = questo è il passato: prima tornare ad adesso
dead-goes-on = la missione prosegue già
dead-comes-home = il robot torna già alla base
dead-at-home = il robot è già alla base
dead-no-too-high = non c'è una TROPPO ALTA da ritirare

## Mission

mission = Missione
start = AVVIA
back-home = ALLA BASE
start-refused = AVVIA: { $reason }.
retrieve = RECUPERA
retrieve-refused = RECUPERA: { $reason }.
nothing-holds = Niente blocca i robot.
held-by = <b>Bloccato:</b> { $what }
fault-is = <b>Guasto:</b> { $what }
unrecorded = <b>Non si può registrare niente:</b> { $why }. Il robot sta fermo finché non è riparato e non si preme AVVIA.
piece-waits = il bagaglio #{ $id } attende il verdetto
interrupted = { $phase } (prima: { $before })
hold-fetchers-called = i robot che recuperano hanno chiamato: prima confermare il loro allarme
hold-with-why = { $hold }: { $why }
hold-waits-for-operator = in attesa dell'operatore
hold-too-hot = troppo caldo: { $readings }; servono { $cool } o meno
reading-of = { $source } { $reading }
next = <b>Poi:</b> { $what }
next-retrieve = RECUPERA lo fa portare nel contenitore.
next-after-alarm = Quando la sala è di nuovo sicura, confermare l'allarme, poi premere ARCHIVIA per archiviare questa missione.
next-reset = Quando la sala è di nuovo sicura, premere ARCHIVIA per archiviare questa missione.
next-secured = { $what }. AVVIA comincia una nuova ricerca, ARCHIVIA archivia questa missione.
next-explored = Tutto ciò che si raggiunge da qui è stato esplorato. AVVIA lo esplora di nuovo, ARCHIVIA archivia questa missione.
secured-one = il bagaglio #{ $id } è nel contenitore
secured-many = i bagagli { $ids } sono nel contenitore
announced-searched = Celle esplorate: almeno { $count }.
announced-waits = Il bagaglio #{ $id } attende il verdetto.

## Progress

progress-searched = esplorate <b>{ $searched }</b>
progress-reach = da qui si raggiungono { $reachable } celle libere su { $free }
progress-none = La ricerca non è cominciata.
progress-forecast = Solo il tempo di guida, al passo tenuto finora: foto e risposte si aggiungono. Ha retto in 95 momenti su 100 di ricerche in sale a caso, e in 83 in sale di corridoi.
progress-gone = <b>{ $time }</b> dall'inizio
progress-gone-now = <b data-since="{ $since }">{ $time }</b> dall'inizio
progress-began = cominciata { $time }
cells = { $count ->
    [one] { $count } cella
   *[other] { $count } celle
}
cells-and-area = { $cells }, { $area } m²
open-places = { $count ->
    [0] niente è aperto: tutto ciò che si raggiunge è esplorato
    [one] 1 posto ancora aperto
   *[other] { $count } posti ancora aperti
}
left-least = ancora almeno { $least } di guida
left-range = ancora da { $least } a { $most } di guida

## Alarms and the incident

alarms = Allarmi
alarm-at = <b>⚠ Allarme</b> <time class="num">{ $time }</time><br>{ $text }
alarm-unrecorded = <b>⚠ Allarme</b> <time class="num">{ $time }</time> (non ancora registrato)<br>{ $text }
alarm-then = <b>Allarme</b> dato alle <time class="num">{ $time }</time>, allora non confermato:<br>{ $text }
acknowledge = Confermare
incident = { $count ->
    [one] ⚠ Pericolo: una bomba nella sala
   *[other] ⚠ Pericolo: { $count } bombe nella sala
}
incident-then = { $count ->
    [one] Pericolo allora: una bomba era nella sala
   *[other] Pericolo allora: { $count } bombe erano nella sala
}
incident-acknowledged = Allarme alle <time class="num">{ $raised }</time>; confermato da <b>{ $who }</b> alle <time class="num">{ $seen }</time>
incident-alarm = <b>Allarme</b> alle <time class="num">{ $time }</time>: { $text }.<br><b>Nessuno l'ha ancora confermato.</b>
incident-unrecorded = <b>Allarme</b> alle <time class="num">{ $time }</time> (non ancora registrato): { $text }.
incident-bomb = <b>Bagaglio #{ $id }</b> in { $place }:<br>{ $from_home }
incident-bomb-held = Il <b>bagaglio #{ $id }</b> è in trasporto ({ $now }); era in { $place }
incident-found = giudicato pericoloso da { $who } alle { $time }
incident-more = { $count ->
    [one] E un altro: si vedano i bagagli più sotto.
   *[other] E altri { $count }: si vedano i bagagli più sotto.
}
evacuate-no-circle = Tenersi a { $metres } m di distanza. Nessun cerchio è disegnato: il lato di una cella non è noto.
evacuate-all = Tenersi a { $metres } m di distanza: tutta la sala nota è entro questa distanza.
evacuate-circle = Tenersi a { $metres } m di distanza: il cerchio rosso nella sala.
incident-next-home = La ricerca è finita, il robot torna alla base. Poi il bagaglio può essere recuperato, o la sala messa in sicurezza.
incident-next-fetched = Il bagaglio viene recuperato e portato nel contenitore.
incident-next-fault = Il robot è in guasto, e niente si muove da solo.
incident-next-phase = Il robot: { $phase }.
incident-halted-home = Il ritorno del robot alla base è sospeso: { $holds }.
incident-halted-fetched = Il recupero è sospeso: { $holds }.
goes-on-acknowledge = Confermare l'allarme, poi premere AVVIA.
goes-on-ok = Premere TEMPERATURA OK, poi AVVIA.
goes-on-start = AVVIA fa proseguire.
goes-on-later = Quando sarà passato, AVVIA fa proseguire.

## Where something is

place = colonna { $column }, riga { $row }
from-home-none = alla base
from-home-metres = { $metres } m a { $side }
from-home-cells = { $count ->
    [one] { $count } cella a { $side }
   *[other] { $count } celle a { $side }
}
from-home = { $sides } della base
from-home-straight = { $sides } della base, { $metres } m in linea d'aria

## The piece that waits

inspect-title = Bagaglio #{ $id }
inspect-waits = attende da <b>{ $time }</b>
inspect-waits-now = attende da <b data-since="{ $since }">{ $time }</b>
photo-large = Grande
photo-usual = Indietro
no-photo = Non c'è nessuna foto: { $why }.
no-photo-ask-again = Non c'è nessuna foto: { $why }. Può essere rifatta; PERICOLO non ne ha bisogno.
safe-button = ✓ SICURO #{ $id }
danger-button = ▲ PERICOLO #{ $id }…
danger-question = Il bagaglio #{ $id } è pericoloso?
danger-consequence = La ricerca finisce, scatta l'allarme e il robot torna alla base. Un verdetto è definitivo.
danger-yes = Sì: PERICOLO #{ $id }
key-safe = s
key-danger = p
note-label = Nota, conservata con il verdetto
note-optional = (facoltativa)
note-kept = Nota, conservata con il verdetto: { $note }
photo-in-question = La foto in questione
where-and-when = Il bagaglio è in { $place }: { $from_home }; visto da { $from }, verso { $heading }; { $time }
takes-earlier = Foto precedenti del bagaglio #{ $id }
take-earlier = foto precedente { $take }
retake = Rifare la foto
verdict-title = Verdetto
nothing-waits = Nessun bagaglio attende un verdetto. La sua foto e i pulsanti SICURO e PERICOLO saranno qui.
nothing-waited = Nessun bagaglio attendeva un verdetto.

## Luggage

luggage-title = Bagagli
luggage-more = altri { $count } nella pagina della missione
simulator-is-paused = <b>In pausa:</b> il tempo del simulatore è fermo. <a href="/simulator">Riprendere</a>
luggage-none = Nessuno è stato ancora incontrato.

## Temperature

temperature = Temperatura
temperature-limit = soglia { $threshold }
temperature-no-reading = nessuna lettura
temperature-unread = nessun termometro è stato letto: nessuno dice quanto fa caldo
temperature-unheard = nessun termometro si fa sentire: nessuno dice quanto fa caldo
reading-age = letta <b data-since="{ $since }" data-old="{ $old }">{ $time }</b> fa
reading-on-record = registrata dalle { $time }
reading-lost-then = allora non nota; ultimo dato: { $last }
temperature-ok = nella norma
temperature-declared = troppo alta secondo un operatore: premere OK per ritirarlo
temperature-high = troppo alta: niente si muove
temperature-stale = sensore muto: niente si muove
temperature-reported = Un operatore ha riferito { $reading }. Vale finché non è riferita una lettura di { $cool } o meno.
temperature-sensor = { $source } legge { $reading }. Deve scendere a { $cool } o meno.
temperature-sensor-silent = { $source } ha letto { $reading } per ultimo, e tace. Deve scendere a { $cool } o meno.
temperature-ok-button = OK
temperature-ok-act = TEMPERATURA OK
temperature-high-button = TROPPO ALTA
temperature-field = Lettura in °C
temperature-report = Registrare

## Robots

robot = Robot
robot-state = Stato
robot-heading = Direzione
robot-position = Posizione
robot-sonar = Sonar
robot-load = Carico
robot-no-link = Senza collegamento
robot-kind = Tipo
robot-address = Indirizzo
robot-parts = Parti
robot-instead = Al posto di ciò che manca
robot-lacks = Senza { $part }
before-entrance = davanti all'ingresso
off-centre = { $place }, fuori centro
sonar-none = assente
sonar-nothing = niente vicino
parts-unknown = non note finché non c'è collegamento
load-none = nessuno
load-held = in presa
load-lifted = in presa, sollevato
load-on-floor = in presa, sul pavimento
doing-held = bloccato da STOP
doing-halting = si arresta …
doing-pair = la coppia si muove
doing-no-link = senza collegamento
doing-stopped = è fermo
doing-movingForward = avanza
doing-movingBackward = indietreggia
doing-rotateLeft = gira a sinistra
doing-rotateRight = gira a destra
doing-takingPhoto = scatta una foto
doing-sendingPhoto = invia la foto
doing-movingArm = muove il braccio
hall-reckoned = Nessun file della scena: il robot stima il percorso dal tempo. Pareti e bagagli possono trovarsi una cella accanto a dove sono mostrati.
hall-in-words = Esplorate { $searched }; { $open }; { $robot }.
hall-robot-at = il robot in { $place }, verso { $heading }
hall-robot-outside = il robot davanti all'ingresso
hall-piece-waits = Il bagaglio #{ $id } in { $place } attende il verdetto.
hall-piece-dangerous = Il bagaglio #{ $id } in { $place } è pericoloso.
hall-pieces = Bagagli trovati: { $count }.

## Search order, putting away, driving by hand

more = Ordine di ricerca, archiviazione, guida a mano
strategy = Ordine di ricerca
strategy-choose = Scegliere
reset-question = Archiviare questa missione?
reset-what = Archiviare questa missione
reset-consequence = La missione è archiviata; alla base si svuota anche la mappa. Niente si muove.
reset-yes = Sì: ARCHIVIA
reset-button = ARCHIVIA…
drive = Guida a mano
drive-forward = avanti
drive-left = sinistra
drive-back = indietro
drive-right = destra
drive-column = Colonna
drive-row = riga
drive-go = Andare là

## When a piece waits

attention-title = Quando un bagaglio attende, o scatta un allarme
attention-notify = avvisare mentre questa pagina non è in vista
attention-sound = emettere un suono

## Log

log-title = Che cosa è successo
log-missions = Tutte le missioni
log-lines = Cronaca, dalla più recente

## Retrieval

retrieval-of = Recupero del bagaglio #{ $id } <span class="quiet">da parte di: { $who }</span>
retrieval = Recupero
retrieval-not = <b>Non può essere recuperato:</b> { $why }
retrieval-secured = Il bagaglio è nel contenitore.
retrieval-again = Rivedere il recupero, momento per momento
retrieval-robot = Robot { $robot }
retrieval-gripper = Pinza
gripper-open = aperta
gripper-closed = chiusa
retrieval-force = Forza
retrieval-angle = Paletta dalla verticale
retrieval-gap = Scarto dal voluto
fetcher-pair = la coppia
fetcher-discovery = il robot della ricerca
fetcher-none = nessuno
stage-pair-makingRoom = il robot della ricerca fa posto
stage-pair-fetching = la coppia recupera il bagaglio
stage-pair-goingOut = la coppia esce
stage-pair-comingHome = il robot della ricerca torna alla base
stage-discovery-fetching = il robot della ricerca recupera il bagaglio
stage-discovery-lettingGo = mette il bagaglio nel contenitore
wanted-acknowledge = confermare, poi AVVIA
wanted-ok = temperatura OK, poi AVVIA
wanted-start = AVVIA continua
tree = Albero { $tree }
blackboard = Lavagna
blackboard-tick = ciclo { $tick }
blackboard-nothing = Sulla lavagna non c'è ancora scritto niente.
blackboard-empty = vuoto
node-ticked = <b>bordo spesso</b>
node-ticked-last = attivato nell'ultimo ciclo
node-idle = fermo
node-running = in corso
node-success = riuscito
node-failure = fallito
node-skipped = saltato

## The picture of the hall

mark-visited = visitata
mark-unknown = ignota
mark-seen = vista dal sonar
mark-frontier = frontiera
mark-wall = parete
mark-todo = non ispezionata
legend-robot = robot
legend-fetcher = robot che recupera
legend-arm = braccio in presa
legend-container = contenitore
legend-sonar = sonar
legend-home = base
legend-goal = meta
legend-path = percorso previsto
legend-trail = scia
goal-at = meta { $cell }
letter-safe = S
letter-danger = P
letter-pending = ?
piece-is = bagaglio #{ $id }: { $verdict }
pieces-are = { $count } bagagli: { $what }
counted-danger = { $count ->
    [one] { $count } pericoloso
   *[other] { $count } pericolosi
}
counted-pending = { $count } da decidere
counted-safe = { $count ->
    [one] { $count } sicuro
   *[other] { $count } sicuri
}
container-empty = contenitore: vuoto
container-holds = contenitore: { $pieces }
luggage-number = bagaglio #{ $id }
container-more = { $count ->
    [one] e un altro
   *[other] e altri { $count }
}

## Time

time = Tempo
time-of-mission = Momento della missione
time-ends = La linea finisce qui, dopo { $most } voci. Il seguito è nel registro della missione: ogni riga porta al suo momento.
lane-phase = fase
lane-luggage = bagagli
lane-commands = comandi
replay = Riproduzione
replay-start = All'inizio
replay-start-key = all'inizio (Home)
replay-backwards = Riprodurre all'indietro
replay-backwards-key = riprodurre all'indietro
replay-back = Una voce indietro
replay-back-key = una voce indietro (←)
replay-play = Riprodurre
replay-play-key = riprodurre o fermare (spazio)
replay-on = Una voce avanti
replay-on-key = una voce avanti (→)
replay-speed = Velocità della riproduzione
replay-from-beginning = Guardare questa missione dall'inizio
back-to-now = Tornare ad adesso
moment = { $time }, voce { $entry } della missione { $mission }
moment-none = Nessuna missione è ancora cominciata.
moment-now = adesso

## Keys

keys = Tasti
keys-stop = STOP, in ogni momento
keys-safe = SICURO: il bagaglio che attende è sicuro
keys-danger = PERICOLO: chiede ancora una volta
keys-photo = la foto grande quanto la finestra, o indietro
keys-zoom = sulla foto: più grande, più piccola, intera
keys-move = sulla foto: spostarla
keys-hall = sulla sala: ingrandisce, riduce, intera, e sposta
keys-time = sulla linea del tempo: una voce, l'inizio, la fine, riproduce
key-home = Inizio
key-end = Fine
key-space = spazio
keys-list = questo elenco
keys-typing = Mentre si scrive, e con Ctrl, Alt o ⌘, questi tasti qui non fanno niente.
close = Chiudere
