# La console dell'operatore.

## The bar and the frame

skip = Alle domande e ai comandi
revision = rev
sign-out = Uscire
lost = <b>Collegamento perso.</b> La pagina mostra lo stato delle <span id="lost-since"></span>, forse non più valido. STOP prova comunque a raggiungere hallsweep.
viewer-notice = Accesso come osservatore: si vede tutto e si può premere STOP. Per tutto il resto serve la chiave di un operatore.
no-scripts = Gli script sono disattivati: questa pagina mostra lo stato del <b>{ $time }</b>.
look-again = Ricaricare
live-loaded = com'era
live-opening = si collega
live-on = in diretta
live-lost = perso
live-unlinked = senza robot
not-known = non si sa
unknown-since = non si sa dalle { $time }; ultimo dato: { $last }
side = Domande, comandi, bagagli e cronaca
tabs = Che cosa si vede sotto i bagagli
sheet = Stato, guida, registro o alberi
tab-status = Stato
tab-drive = Manuale
tab-log = Registro
tab-trees = Alberi
keys-open = Tasti (?)
no-emergency-stop = STOP in questa pagina è un arresto operativo, non di emergenza: restare a portata di mano dell'interruttore del robot.
hall = Sala
hall-known = La parte nota della sala
lens = Parte della sala che si vede
lens-closer = Più vicino
lens-closer-key = più vicino (+)
lens-wider = Più lontano
lens-wider-key = più lontano (−)
lens-whole = Tutta la sala
lens-whole-key = tutta la sala (0)
lens-follow = Segui il robot
legend = Legenda
go-back = No, tornare indietro
past-now = <b>Passato:</b> stato delle { $time }
goal-short = → meta { $cell }
halted = fermo
led = LED { $state }
led-none = assente
led-blinking = lampeggia
led-off = spento
led-unknown = non noto

## Why buttons are dead

dead-viewer = l'accesso è da osservatore
dead-past = la pagina mostra il passato: prima tornare ad adesso
dead-goes-on = la missione è già in corso
dead-comes-home = il robot torna già alla base
dead-at-home = il robot è già alla base
dead-no-too-high = non c'è una TROPPO ALTA da annullare

## Mission

mission = Missione
start = AVVIA
back-home = ALLA BASE
start-refused = AVVIA: { $reason }.
retrieve = RECUPERA
retrieve-one = RECUPERA #{ $id }
retrieve-refused = RECUPERA: { $reason }.
nothing-holds = Pronto
held-by = <b>Bloccato:</b> { $what }
fault-is = <b>Guasto:</b> { $what }
unrecorded = <b>Non si può registrare niente:</b> { $why }. Il robot resta fermo finché la registrazione non riprende e non si preme AVVIA.
piece-waits = il bagaglio #{ $id } attende il verdetto
piece-waited = il bagaglio #{ $id } attendeva il verdetto
interrupted = { $phase } (prima: { $before })
hold-fetchers-called = i robot che recuperano hanno dato un allarme: prima confermare l'allarme
hold-with-why = { $hold }: { $why }
hold-declared = un operatore ha impostato la temperatura su TROPPO ALTA
hold-waits-for-operator = in attesa dell'operatore
hold-too-hot = troppo caldo: { $readings }; servono { $cool } o meno
reading-of = { $source } { $reading }
next = <b>Poi:</b> { $what }
next-retrieve = Premere RECUPERA per portare il bagaglio nel contenitore.
next-acknowledge = Confermare l'allarme.
next-acknowledge-retrieve = Confermare l'allarme, poi premere RECUPERA per portare il bagaglio nel contenitore.
next-go-on = Oppure premere PROSEGUI LA RICERCA: può esserci un'altra bomba.
next-kept-out = Quando una bomba è nel contenitore, si possono cercare i posti nella sua zona vietata.
go-on = PROSEGUI LA RICERCA
go-on-what = Può esserci un'altra bomba
close-what = Dichiarare chi termina la ricerca.
close-link = Chiudere la missione…
close-title = Chiudere la missione
close-nothing-open = Nessun punto è aperto: ogni bagaglio ha il suo verdetto e ogni posto noto è stato esplorato. Ciò non prova che non ci sia alcun ordigno.
close-open = Questi punti sono aperti:
close-consequence = La chiusura registra chi termina la ricerca, quando e che cosa resta aperto. Nulla la attende, e i robot restano come sono. Decade quando un robot si muove di nuovo o un altro bagaglio è giudicato.
close-name = Nome della persona responsabile
close-note = Nota
close-button = Chiudere la missione
hand-over-link = Consegnare…
hand-over-what = Registrare a chi è consegnata questa missione.
hand-over-none = Nessuna missione è in corso: non c’è nulla da consegnare.
hand-over-title = Consegnare la missione
hand-over-consequence = La consegna registra chi affida la missione e il relativo registro, a chi e quando. La ricevuta riporta un codice che permette di verificare il registro in seguito. Non cambia nient’altro.
hand-over-to = Persona o ufficio che prende in consegna
hand-over-button = Consegnare
closed-by = Chiusa da { $name } alle { $time }.
next-reset = Quando la sala è di nuovo sicura, premere ARCHIVIA per archiviare questa missione.
next-secured = { $what }. AVVIA archivia questa missione e comincia una nuova ricerca, ARCHIVIA la archivia soltanto.
next-explored = Tutto ciò che si raggiunge da qui è stato esplorato. AVVIA archivia questa missione ed esplora tutto di nuovo, ARCHIVIA la archivia soltanto.
secured-one = il bagaglio #{ $id } è nel contenitore
secured-many = i bagagli { $ids } sono nel contenitore
announced-searched = Celle esplorate: almeno { $count }.
announced-waits = Il bagaglio #{ $id } attende il verdetto.

## Progress

progress-searched = esplorate <b>{ $searched }</b>
progress-reach = { $reachable } celle libere su { $free } raggiungibili
progress-none = La ricerca non è cominciata.
progress-forecast = Stima del tempo di guida al passo tenuto finora, senza foto e risposte. La stima era giusta in 95 momenti su 100 in sale a caso, e in 83 su 100 in sale di corridoi.
progress-gone = <b>{ $time }</b> dall'inizio
progress-gone-now = <b data-since="{ $since }">{ $time }</b> dall'inizio
progress-began = cominciata { $time }
cells = { $count ->
    [one] { $count } cella
   *[other] { $count } celle
}
cells-and-area = { $cells }, { $area } m²
open-places = { $count ->
    [0] nessun posto ancora da esplorare
    [one] 1 posto ancora da esplorare
   *[other] { $count } posti ancora da esplorare
}
kept-out-places = { $count ->
    [one] 1 posto in una zona vietata
   *[other] { $count } posti in zone vietate
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
incident-alarm = <b>Allarme</b> alle <time class="num">{ $time }</time>: { $text }. <b>Nessuno ha ancora confermato questo allarme.</b>
incident-unrecorded = <b>Allarme</b> alle <time class="num">{ $time }</time> (non ancora registrato): { $text }.
incident-bomb = <b>Bagaglio #{ $id }</b> in { $place }:<br>{ $from_home }
incident-bomb-held = Il <b>bagaglio #{ $id }</b> è in trasporto ({ $now }); era in { $place }
incident-found = giudicato pericoloso da { $who } alle { $time }
incident-more = { $count ->
    [one] E un altro: si veda l'elenco di questa missione.
   *[other] E altri { $count }: si veda l'elenco di questa missione.
}
evacuate-no-circle = Tenersi a { $metres } m di distanza. La pagina non mostra il cerchio perché il lato di una cella non è noto.
evacuate-all = Tenersi a { $metres } m di distanza: tutta la sala nota è entro questa distanza.
evacuate-circle = Tenersi a { $metres } m di distanza: restare fuori dal cerchio rosso sulla mappa.
evacuate-inner = Stare ad almeno { $metres } m, anche negli edifici: fuori dal cerchio rosso interno sulla mappa.
evacuate-outdoors = Tra { $from } m e { $to } m entrare in un edificio, lontano da finestre e muri esterni.
checklist = Lista di controllo
checklist-floors = Sgomberare anche i piani sopra e sotto.
checklist-radio = Niente radio e telefoni entro 15 m dal bagaglio.
checklist-second = Cercare un altro ordigno lungo le uscite e dove si raduna la gente.
checklist-hands = Nessuno tocca o sposta il bagaglio con le mani.
size-ask = Dimensione (facoltativa)
size-unknown = non nota
size-metres = o raggio di sgombero in m
size-legend = Quanto può essere grande l’ordigno?
incident-next-home = La ricerca è finita e il robot torna alla base. Quando il robot è alla base, si può recuperare il bagaglio o mettere in sicurezza la sala.
incident-next-search = La ricerca prosegue, perché può esserci un'altra bomba. Quando il robot è alla base, il bagaglio può essere recuperato.
incident-next-back = Il robot torna alla base. Quando è alla base, il bagaglio può essere recuperato.
incident-next-fetched = Il bagaglio viene recuperato e portato nel contenitore.
incident-next-fault = Il robot ha un guasto, e niente si muove da solo.
incident-next-phase = Il robot: { $phase }.
incident-halted-home = Il ritorno del robot alla base è sospeso: { $holds }.
incident-halted-search = La ricerca è sospesa: { $holds }.
incident-halted-back = Il ritorno del robot alla base è sospeso: { $holds }.
incident-halted-fetched = Il recupero è sospeso: { $holds }.
goes-on-acknowledge = Confermare l'allarme, poi premere AVVIA.
goes-on-ok = Premere TEMPERATURA OK, poi AVVIA.
goes-on-start = Premere AVVIA per proseguire.
goes-on-later = Quando questa causa è passata, premere AVVIA per proseguire.

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
photo-large = Ingrandire
photo-usual = Ridurre
no-photo = Non c'è nessuna foto: { $why }.
no-photo-ask-again = Non c'è nessuna foto: { $why }. Rifare la foto, o premere PERICOLO senza foto.
safe-button = ✓ SICURO #{ $id }
danger-button = ▲ PERICOLO #{ $id }…
unsure-button = ? INCERTO: riguardare #{ $id }
danger-question = Il bagaglio #{ $id } è pericoloso?
danger-consequence = La ricerca finisce, scatta l'allarme e il robot torna alla base. Un verdetto è definitivo.
danger-consequence-goes-on = Scatta l'allarme e la ricerca prosegue. Un verdetto è definitivo.
danger-yes = Sì: PERICOLO #{ $id }
key-safe = s
key-danger = p
key-unsure = i
hot-title = Tre domande
hot-required = (obbligatorie per SICURO)
hot-optional = (facoltative)
hot-question-hidden = Nascosto?
hot-question-obvious = Chiaramente sospetto?
hot-question-typical = Tipico di questo luogo?
inspect-two = SICURO richiede due giudici con chiavi diverse. La risposta del primo resta nascosta al secondo. Un solo PERICOLO basta.
inspect-views = Seguono altre foto da altri posti. Si può rispondere intanto.
inspect-unsure = Meglio: ora giudica un'altra persona, se c'è.
kept-back = La risposta sul bagaglio #{ $id } è registrata. Resta nascosta finché un altro giudice non ha risposto.
note-label = Nota, conservata con il verdetto
note-optional = (facoltativa)
note-kept = Nota, conservata con il verdetto: { $note }
photo-in-question = La foto in questione
where-and-when = Il bagaglio è in { $place }: { $from_home }; visto da { $from }, verso { $heading }; { $time }
takes-earlier = Foto precedenti del bagaglio #{ $id }
take-earlier = foto precedente { $take }
retake = Rifare la foto
verdict-title = Verdetto
nothing-waits = Nessun bagaglio attende un verdetto. Quando un bagaglio attende, qui appaiono la sua foto e i pulsanti SICURO e PERICOLO.
nothing-waited = Nessun bagaglio attendeva un verdetto.

## Luggage

luggage-title = Bagagli
luggage-more = altri { $count } nella pagina della missione
simulator-is-paused = <b>In pausa:</b> il tempo del simulatore è fermo. <a href="/simulator">Riprendere</a>
luggage-none = Nessun bagaglio è stato ancora trovato.

## Temperature

temperature = Temperatura
temperature-limit = soglia { $threshold }
temperature-no-reading = nessuna lettura
temperature-unread = nessun termometro è stato letto: la temperatura non è nota
temperature-unheard = nessun termometro risponde: la temperatura non è nota
reading-age = letta <b data-since="{ $since }" data-old="{ $old }">{ $time }</b> fa
reading-on-record = registrata alle { $time }
reading-lost-then = allora non nota; ultimo dato: { $last }
temperature-ok = normale
temperature-declared = troppo alta (operatore)
temperature-high = troppo alta: niente si muove
temperature-stale = sensore muto: niente si muove
temperature-reported = Un operatore ha riferito { $reading }. Questa lettura vale finché non è riferita una lettura di { $cool } o meno.
temperature-sensor = { $source } legge { $reading }; la lettura deve scendere a { $cool } o meno.
temperature-sensor-silent = { $source } ha letto { $reading } per ultimo e ora tace; la lettura deve scendere a { $cool } o meno.
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
robot-instead = Sostituti delle parti mancanti
robot-lacks = Senza { $part }
before-entrance = davanti all'ingresso
off-centre = { $place }, fuori centro
sonar-none = assente
sonar-nothing = niente vicino
parts-unknown = non note finché non c'è collegamento
load-none = nessuno
load-lifted = in presa, sollevato
load-on-floor = in presa, sul pavimento
doing-held = bloccato da STOP
doing-halting = si arresta …
doing-pair = la coppia si muove
doing-no-link = senza collegamento
doing-stopped = fermo
doing-movingForward = avanza
doing-movingBackward = indietreggia
doing-rotateLeft = gira a sinistra
doing-rotateRight = gira a destra
doing-takingPhoto = scatta una foto
doing-sendingPhoto = invia la foto
doing-movingArm = muove il braccio
hall-reckoned = Nessun file della scena: il robot stima la posizione dal tempo di guida. Pareti e bagagli possono trovarsi a una cella da dove li mostra la mappa.
hall-in-words = Esplorate { $searched }; { $open }; { $robot }.
hall-robot-at = il robot in { $place }, verso { $heading }
hall-robot-outside = il robot davanti all'ingresso
hall-piece-waits = Il bagaglio #{ $id } in { $place } attende il verdetto.
hall-piece-dangerous = Il bagaglio #{ $id } in { $place } è pericoloso.
hall-pieces = Bagagli trovati: { $count }.

## Search order, putting away, driving by hand

more = Ordine di ricerca, archiviazione, guida a mano
strategy = Ordine di ricerca
strategy-choose = Impostare
reset-question = Archiviare questa missione?
reset-what = Archiviare questa missione
reset-consequence = ARCHIVIA archivia la missione; alla base svuota anche la mappa. Niente si muove.
reset-yes = Sì: ARCHIVIA
reset-button = ARCHIVIA…
areas = Aree
areas-what = La ricerca prende le aree in quest’ordine. Le aree senza numero vengono dopo le altre, in un ordine scelto dalla ricerca.
areas-automatic = Lasciare l’ordine alla ricerca
area-open = aperta
area-closed = chiusa
area-closed-by = chiusa da { $name } alle { $time }
area-earlier = Prima
area-earlier-of = { $area }: prima
area-later = Dopo
area-later-of = { $area }: dopo
area-again-of = { $area }: riesplorare
area-close = Chiudere…
area-close-of = { $area }: chiudere…
area-close-title = Chiudere l’area { $area }
area-close-consequence = La chiusura registra chi termina la ricerca di quest’area, quando e che cosa vi resta aperto. La ricerca tralascia il resto dell’area. Nulla la attende. Per riaprire l’area, riesplorarla.
area-close-button = Chiudere l’area
area-close-none = Quest’area non si può chiudere ora: nessuna missione è in corso, l’area è già chiusa o la sala non ha quest’area.
again = Riesplorare un’area
again-what = Il robot visita ancora una volta tutte le celle esplorate tra due angoli. Gli angoli si possono scegliere anche sulla mappa.
again-to-column = alla colonna
again-to-row = alla riga
again-go = Riesplorare
again-cells = { $count ->
    [one] 1 cella da riesplorare
   *[other] { $count } celle da riesplorare
}
drive = Guida a mano
drive-forward = avanti
drive-left = sinistra
drive-back = indietro
drive-right = destra
drive-column = Colonna
drive-row = riga
drive-go = Andare là

## When a piece waits

attention-title = Avvisi di bagagli in attesa e di allarmi
attention-notify = avvisare mentre questa pagina non è in vista
attention-sound = emettere un suono

## Log

log-title = Che cosa è successo
log-missions = Tutte le missioni
log-lines = Cronaca, dalla più recente

## Retrieval

retrieval-of = Recupero del bagaglio #{ $id } <span class="quiet">da parte di: { $who }</span>
retrieval = Recupero
retrieval-not = <b>Il bagaglio non può essere recuperato:</b> { $why }
retrieval-again = Rivedere il recupero passo per passo
retrieval-gripper = Pinza
gripper-open = aperta
gripper-closed = chiusa
retrieval-force = Forza
retrieval-angle = Angolo della paletta dalla verticale
retrieval-gap = Errore di distanza
fetcher-pair = la coppia
fetcher-discovery = il robot della ricerca
fetcher-none = nessuno
stage-pair-makingRoom = chi ha cercato libera la via
stage-pair-fetching = la coppia recupera il bagaglio
stage-pair-goingOut = la coppia lo porta fuori
stage-pair-comingHome = chi ha cercato torna alla base
stage-discovery-fetching = chi ha cercato recupera il bagaglio
stage-discovery-lettingGo = chi ha cercato mette il bagaglio nel contenitore
wanted-acknowledge = confermare, poi premere AVVIA
wanted-ok = premere TEMPERATURA OK, poi AVVIA
wanted-start = premere AVVIA per proseguire
tree = Albero { $tree }
blackboard = Lavagna
blackboard-tick = ciclo { $tick }
blackboard-nothing = La lavagna è ancora vuota.
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
legend-arm = braccio con carico
legend-container = contenitore
legend-sonar = sonar
legend-home = base
legend-area = area
legend-area-closed = area chiusa
legend-again = da riesplorare
legend-keep-out = zona vietata
keep-out-of = zona vietata del bagaglio #{ $id }
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
time-ends = La linea mostra solo le prime { $most } voci. Il registro della missione le elenca tutte, ognuna con il collegamento al suo momento.
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
replay-from-beginning = Rivedere questa missione dall'inizio
back-to-now = Tornare ad adesso
moment = { $time }, voce { $entry } della missione { $mission }
moment-none = Nessuna missione è ancora cominciata.
moment-now = adesso

## Keys

keys = Tasti
keys-stop = STOP, in ogni momento
keys-safe = SICURO: giudica sicuro il bagaglio che attende
keys-unsure = INCERTO: fa fotografare da altri lati il bagaglio che attende
keys-danger = PERICOLO: chiede conferma
keys-hot = passa alla risposta successiva a una domanda sul bagaglio
keys-photo = mostra la foto a tutta finestra, o a misura normale
keys-zoom = sulla foto: ingrandisce, riduce, o mostra la foto intera
keys-move = sulla foto: sposta la foto
keys-hall = sulla sala: ingrandisce, riduce, o mostra tutta la sala; sposta la vista
keys-time = sulla linea del tempo: va di una voce, all'inizio, alla fine; riproduce
key-home = Inizio
key-end = Fine
key-space = spazio
keys-list = mostra questo elenco
keys-typing = Questi tasti non fanno niente mentre si scrive, né insieme a Ctrl, Alt o ⌘.
close = Chiudere
