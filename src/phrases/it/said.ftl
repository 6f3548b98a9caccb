# Quello che dice il nucleo.

## Phases of a mission

phase-idle = in attesa
phase-exploring = in esplorazione
phase-inspecting = ispezione di un bagaglio
phase-driving = guida a mano
phase-returningHome = ritorno alla base
phase-atHome = in attesa alla base
phase-returningWithAlarm = ritorno alla base con allarme
phase-bombLocated = alla base, bomba localizzata
phase-retrieving = recupero del bagaglio
phase-bagSecured = bagaglio al sicuro
phase-explored = sala esplorata
phase-fault = in guasto

## What holds the robots, and what is said when it does not any more

hold-operator = fermato dall'operatore
hold-tooHigh = temperatura troppo alta (pulsante): prima premere OK
hold-temperature = una lettura è sopra la soglia: ogni fonte deve tornare sotto
hold-temperatureStale = il sensore di temperatura è muto: prima ripararlo
hold-robotLink = il robot non è raggiungibile: prima ripristinare il collegamento
hold-store = non si può registrare niente: prima riparare il disco
hold-restart = il programma è stato riavviato; tutto è com'era
hold-alarm = un allarme è aperto: prima confermarlo (o ripetere pericolo, dove un pericolo non si è potuto registrare)
hold-awaitingStart = in attesa di AVVIA
hold-over-operator = non più fermato dall'operatore
hold-over-tooHigh = temperatura OK (pulsante)
hold-over-temperature = ogni lettura è di nuovo sotto la soglia
hold-over-temperatureStale = i sensori di temperatura si sentono di nuovo
hold-over-robotLink = il robot è di nuovo raggiungibile
hold-over-store = tutto è di nuovo registrato
hold-over-restart = si continua dopo il riavvio
hold-over-alarm = l'allarme che bloccava è confermato, o il pericolo registrato
hold-over-awaitingStart = avviato
hold-brief-operator = fermato dall'operatore
hold-brief-tooHigh = temperatura troppo alta (pulsante)
hold-brief-temperature = una lettura è sopra la soglia
hold-brief-temperatureStale = il sensore di temperatura è muto
hold-brief-robotLink = il robot non è raggiungibile
hold-brief-store = non si può registrare niente
hold-brief-restart = il programma è stato riavviato
hold-brief-alarm = un allarme è aperto
hold-brief-awaitingStart = in attesa di AVVIA

## Words for one thing

heading-north = nord
heading-east = est
heading-south = sud
heading-west = ovest
verdict-safe = sicuro
verdict-danger = pericoloso
verdict-pending = da decidere
role-viewer = osservatore
role-operator = operatore
strategy-auto = automatico
strategy-scored = a punteggio
strategy-frontier = frontiera
strategy-columns = colonne
strategy-spiral = spirale
strategy-snail = chiocciola
move-w = avanti
move-s = indietro
move-a = sinistra
move-d = destra
move-z = poco a sinistra
move-x = poco a destra
part-base = ruote
part-camera = fotocamera
part-sonar = sonar
part-led = LED
part-thermometer = termometro
part-bump = paraurti
part-arm = braccio
part-gripper = pinza
part-acknowledgedMoves = movimenti confermati
instead-camera = un disegno, che dice di esserlo
instead-sonar = toccare ciò che c'è
instead-led = lo mostra solo la console
instead-thermometer = i pulsanti dell'operatore e i sensori della sala
instead-acknowledgedMoves = le mosse sono a tempo

## Why a command was refused

refused-held = non possibile mentre è bloccato: { $holds }
refused-held-store = non si può registrare niente: { $why }
refused-outdated = superato: inviato all'epoca { $sent }, ma da allora uno STOP l'ha portata a { $now }; guardare di nuovo, poi ripeterlo
refused-sentBefore = superato: era già stato inviato, e da allora possono esserci stati uno STOP o un riavvio; guardare di nuovo, poi darlo da capo
refused-notInPhase = non possibile nella fase «{ $phase }»
refused-verdictPending = il bagaglio #{ $id } attende il verdetto: prima rispondere sicuro o pericolo
refused-driving = il robot è guidato a mano: attendere la fine della mossa, o premere STOP
refused-notStopped = il robot è in missione: premere STOP prima di guidarlo a mano
refused-intoObstacle = c'è un ostacolo in { $cell }
refused-notCapable = questo robot non ha piccole rotazioni di correzione
refused-moving = il robot si muove: prima premere STOP
refused-unrecorded = un bagaglio viene registrato: attendere la sua foto
refused-bombUnfetched = il bagaglio #{ $id } è pericoloso e ancora nella sala: prima confermare il suo allarme
refused-unknownLuggage = non c'è nessun bagaglio #{ $id }
refused-notABomb = il bagaglio #{ $id } non è una bomba nella sala: indicare un bagaglio pericoloso non ancora recuperato
refused-openPoints = punti aperti: { $open }; per chiudere la missione con essi, inviare openPoints { $code }
refused-otherMission = ora è in corso la missione { $mission }: guardare di nuovo, poi indicare quella
refused-exerciseOver = i bagagli di prova di questa esercitazione sono ormai noti: avviare di nuovo hallsweep per un’altra esercitazione
refused-nothingSearched = in quest’area non c’è alcuna cella esplorata: indicare due angoli di un’area che il robot ha esplorato
refused-unknownArea = la sala non ha un’area { $area }: indicare una delle sue aree
refused-areaClosed = l’area { $area } è già chiusa: per riaprirla, riesplorarla
refused-areaTooLarge = troppe celle: al massimo { $most } possono attendere di essere riesplorate
refused-nothingPending = nessun bagaglio attende un verdetto
refused-decided = il bagaglio #{ $id } è già stato giudicato ({ $verdict }): un verdetto è definitivo
refused-noPhoto = il bagaglio #{ $id } non ha una foto utilizzabile: rifarla, o rispondere pericolo
refused-hotUnanswered = il bagaglio #{ $id } non può ancora essere dichiarato sicuro: prima indicare se è nascosto, chiaramente sospetto o tipico di questo luogo
refused-notInspected = il bagaglio #{ $id } non è quello in ispezione
refused-photoUnderWay = la foto è in corso
refused-unknownAlarm = non c'è nessun allarme { $id }
refused-noRetrievalRobot = non c'è nessun robot che recupera
refused-fetcherUnreached = { $robot } non è raggiungibile, e il recupero ne ha bisogno: prima ripristinare il suo collegamento
refused-fetcherAbroad = { $robot } non è ancora tornato: premere AVVIA, perché il recupero continui
refused-faultStands = il guasto c'è ancora: { $fault }
refused-storeDown = non si può scrivere il registro, quindi niente è stato deciso: riprovare quando è di nuovo disponibile
refused-notKept = non si è potuto registrare, perché l'archivio ha ceduto: guardare lo stato prima di ripetere
refused-notOnRecord = l'ultima azione non è ancora registrata: attendere un momento
refused-otherContent = l'id { $id } è già stato usato per un altro comando: dare a ogni comando un id suo
refused-unknownSensor = non c'è nessun sensore { $sensor }: nominarlo nell'impostazione temperature.sensor
refused-notAllowed = a chi accede come osservatore non è consentito: vede tutto e può premere STOP

## Faults

fault-noWayHome = nessuna via nota porta alla base: liberare la via, o andare a prendere il robot
fault-undecided = la ricerca non trova il prossimo passo: premere ARCHIVIA e ricominciare
fault-unanswered = il robot non ha finito il suo ordine in tempo: controllarlo, poi premere AVVIA
fault-notFetched = il bagaglio non è stato recuperato: { $why }
fault-robot = il robot non ha potuto eseguire il suo ordine ({ $words }): controllarlo, poi premere AVVIA
not-fetched-nothingToFetch = la coppia non sa che cosa recuperare
not-fetched-noWayToParcel = la coppia non trova modo di afferrare il pacco da due lati e portarlo via
not-fetched-noWayToTarget = la coppia non trova via per portare il pacco dove deve andare
not-fetched-noWayBack = la coppia non trova via per tornare al bancale
not-fetched-wrongParcel = la coppia ha afferrato un pacco diverso da quello per cui era stata mandata
not-fetched-robotFails = un robot della coppia non riesce a fare ciò che gli è detto: controllarlo
not-fetched-lostTooOften = la coppia ha perso il pacco troppe volte
not-fetched-notAligned = la coppia non riesce a portare il pacco esattamente dove va deposto
not-fetched-takesTooLong = un passo del lavoro della coppia dura più di quanto dovrebbe mai
not-fetched-tree = un albero di comportamento non si può eseguire com'è scritto
not-fetched-and = { $why } ({ $words })
saying-callOperator = la coppia non riconosce nessun pacco: guardare che cosa c'è, poi confermare e premere AVVIA
saying-packageLost = la coppia ha perso il pacco: guardare dov'è, poi confermare e premere AVVIA

## What the simulator says, and what was done to what is simulated.

simulated = simulatore: { $changes }
simulated-paused = in pausa
simulated-going-on = riprende
simulated-speed = velocità { $speed }
simulated-speed-max = velocità massima
simulated-linkLost = collegamento interrotto
simulated-linked = collegamento ripristinato
simulated-noThermometer = termometro tolto
simulated-thermometer = termometro rimesso
simulated-cameraFails = fotocamera guasta
simulated-camera = fotocamera riparata
simulated-blocked = ostacoli in { $cells }
simulated-nothing-blocked = nessun ostacolo
simulated-step = simulatore: un passo
simulated-put-down = robot messi nella sala { $hall }
simulated-is-put-down = viene messo nella sala { $hall }
simulated-keeps = simulatore: conservata la sala { $hall }
simulated-discards = simulatore: eliminata la sala { $hall }
simulated-lost = il simulatore tiene interrotto il collegamento
simulated-no-photo = l'otturatore non si è aperto: scattare di nuovo la foto

## What qualifies what a mission came to

robots = Robot
robots-and-seed = { $robots }; seme { $seed }
robots-not-on-record = non registrati
searched-of = { $reachable } celle libere su { $free }
search-ended-there = la ricerca è finita lì
unsearched = { $count ->
    [one] 1 posto noto non esplorato
   *[other] { $count } posti noti non esplorati
}
unsearched-kept-out = { $count ->
    [one] 1 posto noto non esplorato, in una zona vietata
   *[other] { $count } posti noti non esplorati, { $inside } dei quali in zone vietate
}
engine-sim = simulato
engine-virtual = robot virtuale
engine-other = robot { $kind }
engine-not-on-record = non registrato se con robot simulato
