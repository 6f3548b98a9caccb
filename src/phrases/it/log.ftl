# Cronaca, registro e comandi.

## Alarms and why a piece was not fetched

alarm-dangerous = il bagaglio #{ $id } in { $cell } è pericoloso
alarm-dangerous-unrecorded = il bagaglio #{ $id } in { $cell } è detto pericoloso, ma non si è potuto registrarlo
alarm-call = bagaglio #{ $id }: { $saying }
alone-OtherPiece = il robot ha preso un bagaglio diverso da quello per cui era stato mandato
alone-PieceLost = il robot non tiene più il bagaglio, e nel contenitore non c'è
alone-NoWayHome = nessuna via nota porta alla base con il bagaglio
alone-NoWayToPiece = nessuna via porta al bagaglio
alone-CannotTake = il robot non riesce ad afferrare il bagaglio
alone-NotRecognised = il robot non riconosce il bagaglio dove dovrebbe stare
stuck-RobotFails = un robot che recupera non riesce a fare ciò che gli è detto
stuck-NoWayOut = nessuna via riporta fuori i robot che recuperano

## Commands

asked-start = AVVIA
asked-stop = STOP
asked-backHome = ALLA BASE
asked-goOn = PROSEGUI
asked-unsure = incerto
asked-close = chiusura, da { $name }
asked-retrieve = RECUPERA
asked-reset = ARCHIVIA
asked-move = mossa { $move }
asked-searchAgain = riesplorare da { $from } a { $to }
asked-goto = andare a { $cell }
asked-safe = sicuro
asked-danger = pericolo
hot-hidden = nascosto
hot-obvious = chiaramente sospetto
hot-typical = tipico
hot-answer-yes = sì
hot-answer-no = no
hot-answer-cannotSay = non so dire
asked-noted = { $asked } (nota: { $note })
asked-retake = rifare la foto #{ $id }
asked-acknowledge = confermare l'allarme { $id }
asked-strategy = scegliere l'ordine di ricerca { $strategy }
asked-ok = temperatura OK
asked-too-high = temperatura TROPPO ALTA
asked-reading = lettura di temperatura { $celsius }
asked-sensor = lettura di un sensore { $sensor } { $celsius }
asked-stops-at-once = STOP, { $count } volte insieme
asked-stops-within = STOP, { $count } volte in { $seconds } s
asked-many = { $more ->
    [one] { $last }, e un altro che è stato rifiutato
   *[other] { $last }, e altri { $more } che sono stati rifiutati
}
asked-of = { $asked } #{ $id }
issuer = { $who } ({ $door }, { $from })
issuer-local = { $who } ({ $door })

## The log

said-by = { $asked }, da { $issuer }
said-refused = { $asked } rifiutato, da { $issuer }: { $refused }
said-overtaken = un SICURO è stato scavalcato da un PERICOLO, e quindi rifiutato: { $refused }
said-held = bloccato: { $hold }
said-held-why = bloccato: { $hold } ({ $why })
said-unheard = { $sensor } non si è ancora sentito
said-phase = { $before } → { $after }
said-fault = guasto: { $fault }
said-found = bagaglio #{ $id } trovato in { $cell }
said-found-without-photo = bagaglio #{ $id } trovato in { $cell }, ma la sua foto è fallita: rifarla, o rispondere pericolo
said-photographed-again = bagaglio #{ $id } fotografato di nuovo
said-photo-stays = la foto del bagaglio #{ $id } non si è potuta rifare; resta la prima
said-no-other-view = nessun altro posto per una foto del bagaglio #{ $id } si può raggiungere
said-no-way = nessuna via porta a { $cell }
said-home-through-rings = ogni via nota verso la base passa per una zona vietata: il robot resta il più lontano possibile dalla bomba
said-stands = il robot dice di stare in { $cell }, verso { $heading }
said-robot-stands = { $robot } dice di stare in { $cell }, verso { $heading }
said-too-far = { $robot } dice di stare in { $cell }, più lontano dalla base di quanto arrivi una sala
said-no-thermometer = { $robot } ora non ha termometro, e l'ultima lettura era troppo calda: riferire quella della sala
said-still-unreached = { $robot }: { $why }
said-unreached = { $robot } non è raggiungibile ({ $why }): ripristinare il collegamento
said-met-obstacle = { $robot } ha incontrato un ostacolo in { $cell }
said-failed = { $robot } non ha potuto eseguire il suo ordine ({ $why })
said-no-photo = { $robot } non ha fatto la foto ({ $why })
said-unanswered = { $robot } non ha finito il suo ordine in tempo: controllarlo
said-trees-anew = gli alberi della coppia ricominciano: { $why }
said-ended = il programma è stato terminato da { $by }: il robot si ferma
said-put-down = il robot è stato messo in un'altra sala

## What the journal says

fact-started = programma avviato, versione { $version }
fact-conditions = sala: { $hall }, celle di { $side } m, troppo caldo sopra { $threshold }
rule-two-judges = un verdetto SICURO richiede due giudici
rule-hot = un verdetto SICURO richiede le risposte a tre domande
rule-views = altre foto se un giudice è incerto: al massimo { $count }
rule-goes-on = la ricerca prosegue dopo PERICOLO
rule-rings = zone vietate di { $metres } m
fact-conditions-no-side = sala: { $hall }, troppo caldo sopra { $threshold }
fact-conditions-reckoned = sala: { $hall }, posizioni stimate senza file della scena, troppo caldo sopra { $threshold }
fact-written-out = le missioni da { $first } a { $last }, voci fino a { $until }, sono solo nell'archivio { $file }, SHA-256 { $digest }
fact-unpacked = estratto dall'archivio { $file }, SHA-256 { $digest }; comincia dopo la voce { $behind }, il digest della cui pagina è { $page }
fact-clock-back = l'orologio è stato messo indietro di { $by }
fact-clock-forward = l'orologio è andato avanti di { $by }: è stato regolato, o la macchina dormiva
fact-ended = programma terminato da { $by }
fact-state = tutto ciò che vale: missione { $mission }, celle visitate: { $cells }
fact-state-none = tutto ciò che vale: nessuna missione, celle visitate: { $cells }
fact-command = comando { $asked } da { $issuer }: { $outcome }
fact-accepted = accettato
fact-refused = rifiutato: { $why }
fact-mission-began = missione { $mission } cominciata ({ $strategy })
fact-mission-archived = missione { $mission } archiviata, bombe rimaste: { $left }
not-fetched-other-fetcher = è stato cominciato con mission.retrieval = "{ $began }", che ora è "{ $set }": rimetterlo com'era
not-fetched-and-stuck = { $before }; e { $why }
fact-none-left = nessuna
fact-phase = fase: { $phase }
fact-stage = { $phase }: { $stage }
stage-backing-up = arretra
stage-taking-photo = scatta la foto
stage-recording = registra #{ $id }
stage-waits = #{ $id } attende il verdetto
stage-retaking = rifà la foto di #{ $id }
stage-viewing = va a un altro lato di #{ $id }
fact-nothing-holds = niente blocca il robot
fact-held = bloccato: { $holds }
fact-epoch = fermato: epoca { $epoch }
fact-no-goal = nessuna meta
fact-robot-at = robot in { $cell }, verso { $heading }
fact-other-at = { $robot } in { $cell }, verso { $heading }
fact-in-hall = { $robot } è nella sala
fact-outside = { $robot } è fuori, a { $steps } dalla base
fact-retrieval-ended = il recupero è finito
fact-retrieval = recupero del bagaglio #{ $id } ({ $fetcher }): { $how }
by-pair = coppia
by-discovery = robot della ricerca
by-none = nessuno
fetching-room = si fa posto
fetching-fetched = viene recuperato
fetching-let-go = viene messo nel contenitore
fetching-given-up = abbandonato: { $why }
fetching-in-container = è nel contenitore
fetching-not = non recuperato: { $why }
fact-met-again = il bagaglio { $piece } sta anche in { $cell }
fact-led-on = il LED lampeggia
fact-led-off = LED spento
fact-obstacle = ostacolo in { $cell }, preso per { $kind }
obstacle-wall = parete
obstacle-luggage = bagaglio
obstacle-unknown = ignoto
fact-cell = cella { $cell }: { $mark }
cell-unknown = ignota
cell-seen = vista
cell-visited = visitata
cell-wall = parete
cell-luggage = bagaglio
cell-notInspected = non ispezionata
fact-luggage = bagaglio #{ $id } in { $cell }, visto da { $from } verso { $heading }; { $photo }
photographed = fotografato
photographed-take = fotografato, scatto { $take }
photographed-not = senza foto: { $why }
fact-verdict = verdetto sul bagaglio #{ $id }: { $verdict }, da { $who }
fact-judged = risposta tenuta riservata finora: bagaglio #{ $id } { $verdict }, da { $issuer }
fact-unsure = incerto sul bagaglio #{ $id }, da { $who }
fact-search-again = da riesplorare: da { $from } a { $to }
fact-closed = missione chiusa da { $name }, chiave { $who }
fact-closed-open = { $closed }; punti aperti: { $open }
left-open-none = nessuno
left-open-pending = bagagli senza verdetto: { $count }
left-open-bombs = bombe nella sala: { $count }
left-open-places = posti noti non esplorati: { $count }
left-open-keptOut = posti dentro anelli di rispetto: { $count }
left-open-again = celle non riesplorate: { $count }
left-open-unvisited = celle mai visitate: { $count }
left-open-unreachable = celle non raggiungibili: { $count }
fact-verdict-noted = verdetto sul bagaglio #{ $id }: { $verdict }, da { $who } (nota: { $note })
fact-temperature = temperatura { $celsius }, da { $source }
fact-thermometer-silent = il termometro di { $source } tace
fact-alarm = allarme { $alarm }: { $cause }
fact-alarm-seen = allarme { $alarm } confermato da { $who }
fact-strategy = ordine di ricerca: { $strategy }
fact-map-emptied = mappa svuotata, verso { $heading }
