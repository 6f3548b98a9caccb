# Il rapporto di una missione. I rapporti già consegnati dicono queste parole: vedi src/report/mod.rs prima di cambiarne una.

report-title = Rapporto della missione { $id }
report-kind = Ispezione robotizzata di una sala evacuata
report-reference = Riferimento
report-until = missione { $mission }, voce { $entry }
report-summary = Riepilogo
report-cell = Lato di una cella
report-rules = Regole della squadra
report-threshold = Troppo caldo oltre
report-began = Inizio
report-put-away = Archiviata
report-as-of = Non ancora archiviata; aggiornato a
report-took = Durata (h:mm:ss)
report-clock-set = L'orologio è stato cambiato
report-clock-sets = { $count } ×; la durata è quella misurata dal programma mentre era in funzione
report-zone = Gli orari sono in
report-strategy = Ordine della ricerca
report-reckoned = Come è nata la mappa
report-reckoned-so = stimata dal tempo senza file della scena: pareti e bagagli possono trovarsi una cella accanto a dove sono mostrati
report-searched = Esplorato
report-cells = { $cells } celle
report-cells-square = { $cells } celle, { $square } m²
report-reach = Raggiungibile
report-reach-cells = dalla partenza si raggiungono { $reachable } celle libere su { $free }
report-open = Posti noti non esplorati
report-pieces = { $count }: sicuri { $safe }, pericolosi { $danger }, da decidere { $pending }
report-secured-count = Messi nel contenitore
report-finding = Esito
report-no-device = { $count ->
    [0] Nessun bagaglio è stato giudicato.
    [one] Nessun ordigno è stato trovato in 1 bagaglio giudicato.
   *[other] Nessun ordigno è stato trovato in { $count } bagagli giudicati.
}
report-devices = Giudicati pericolosi: { $dangerous } di { $count } bagagli giudicati.
report-closed = Chiusura
report-not-closed = non chiusa
report-stops = STOP premuto
report-accepted = Comandi accettati
report-refused = Comandi rifiutati
report-alarms = Allarmi
report-alarms-seen = { $count }, confermati: { $seen }
report-range = da { $least } a { $most }; la più alta { $time }
report-constant = costante { $least }
report-starts = Riavvii del programma

## Ciò che non si può leggere

report-damage = Che cosa manca qui
report-damaged = Una parte di ciò che è registrato non si può capire. Ciò che ne consegue non è in questo rapporto:
report-damage-more = e altre { $count }
report-not-kept = La sala e i bagagli di questa missione non sono conservati.

## La sala

report-hall-known = La sala, per quanto era nota, con ciò che è stato trovato
report-hall-note = Le celle si contano dalla base, le colonne verso est e le righe verso sud. Il numero dentro un segno è quello del bagaglio.
report-visited = esplorata
report-unknown = ignota
report-wall = parete
report-todo = non ispezionata
report-luggage-cell = bagaglio
report-fetched = recuperato, e non più lì
report-home = base

## Bagagli

report-photo = Foto { $take }
report-photo-failed = Non c'è una foto: { $why }
report-photo-spoilt = La foto { $take } è perduta: il suo file manca, o non è quello registrato.
report-scaled = Le foto sono qui ridotte, perché questa pagina resti piccola. Gli originali sono conservati con il registro, e ogni SHA-256 è quello di un originale: hallsweep lo mostra in /api/v1/luggage/NUMERO/photo?take=FOTO.
report-photo-unscaled = La foto { $take } non è mostrata qui: non si può ridurre. L'originale è conservato con il registro, SHA-256 { $digest }.
report-found = Trovato
report-where = Dove
report-place = { $place }; dalla base { $east } m verso est, { $south } m verso sud
report-verdict = Verdetto
report-verdict-by = dato da { $who }, { $time }
report-no-verdict = nessuno
report-waited = Deciso dopo (h:mm:ss)
report-note = Nota
report-secured = Messo nel contenitore

## La temperatura

report-chart = La temperatura durante la missione
report-chart-note = La lettura più alta di ogni momento. Tratteggiata: la linea oltre la quale fa troppo caldo.
report-no-readings = Nessuna lettura è registrata.

## Tabelle

report-entry = Voce
report-time = Ora
report-what = Che cosa
report-by = Da chi
report-why = Perché
report-none = Nessuna registrazione.
report-refusals = Comandi rifiutati
report-happened = Che cosa è successo

## Righe per le firme

report-signatures = Firme
report-signed-operator = Operatore responsabile
report-signed-receiver = Ricevuto da
report-signed-name = Nome e qualifica
report-signed-date = Luogo, data e ora
report-signed-signature = Firma

## Che cosa prova

report-evidence = Prova
report-evidence-of = Questo rapporto è ricavato dal registro di hallsweep. Contiene ciò che vi è registrato della missione { $mission } fino alla voce { $entry }, e nient'altro.
report-head = Testa del registro
report-head-entry = alla voce { $entry }
report-confirm = Chi ha il registro può confrontarlo con questo file:
report-proves = Il file è confermato solo se da allora non è cambiato un solo byte, né suo né di ciò da cui è ricavato. Questo non prova che il registro non sia stato rifatto prima della consegna di questo rapporto, né che una fotocamera o un termometro abbiano detto il vero.
report-no-head = Il registro era tenuto solo in memoria: nulla può confermare questo rapporto in seguito.

## The results of an exercise

score-title = Come sono stati giudicati i bagagli dell'esercitazione
score-key = Chiave
score-answers = Risposte
score-hits = Bagagli di prova trovati
score-misses = Bagagli di prova non riconosciuti
score-false-alarms = Falsi allarmi
score-correct-safe = Sicuri, a ragione
score-unsure = Incerti
score-median = Tempo di risposta, mediana
score-longest = Tempo di risposta, massimo
score-rate = { $count } ({ $rate } %, intervallo al 95 %: { $low }–{ $high } %)
score-note = I risultati appaiono alla fine dell’esercitazione. Le percentuali sono indicate a partire da 10 bagagli; l’intervallo è quello di Wilson.
